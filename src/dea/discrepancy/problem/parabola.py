"""Where a maximum lies between samples."""

from typing import Any

import numpy as np


def vertex(left: Any, middle: Any, right: Any) -> np.ndarray:
    """Return how far from the middle one of three samples in a row their parabola has its vertex.

    It is counted in samples, at most half of one, and zero where the parabola opens upwards.
    """
    curvature = np.asarray(left - 2.0 * middle + right)
    with np.errstate(divide="ignore", invalid="ignore"):
        beside = np.where(curvature < 0.0, 0.5 * (left - right) / curvature, 0.0)
    result: np.ndarray = np.clip(beside, -0.5, 0.5)
    return result
