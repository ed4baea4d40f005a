"""How far apart two explanations are on an excitation, after each has been refitted."""

from dataclasses import dataclass

import numpy as np

from dea.resolution.error import Error
from dea.resolution.explanation import Explanation


@dataclass(frozen=True)
class Expected:
    """What an explanation expects of an excitation: the whitened output (n,) and its slope (n, k).

    The slope is by coordinates of unit variance.
    """

    output: np.ndarray
    slope: np.ndarray


def expected(output: np.ndarray, slope: np.ndarray, root: np.ndarray, error: Error) -> Expected:
    """Whiten a predicted output (n,) and its slope (n, k) by coordinates with this ``root``."""
    return Expected(error.whitened(output), error.whitened(slope @ root))


def squared_distance(truth: Expected, rival: Expected) -> float:
    """Return the squared distance, in units of the error, that refitting the rival leaves.

    The rival's step costs what its belief makes it cost: with the difference d and the slope J it
    is the minimum of |d - J x|² + |x|², which is d' (I + J J')⁻¹ d.
    """
    d, J = truth.output - rival.output, rival.slope
    pull = J.T @ d
    return float(max(d @ d - pull @ np.linalg.solve(np.eye(pull.size) + J.T @ J, pull), 0.0))


def nested(first: Explanation, second: Explanation) -> bool:
    """Return whether the effects of one are among those of the other."""
    return set(first.labels) <= set(second.labels) or set(second.labels) <= set(first.labels)
