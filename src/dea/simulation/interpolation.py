"""Input interpolation: what an input does between its samples."""

from typing import Literal, get_args

import numpy as np
from scipy.ndimage import map_coordinates

from dea.inputs import by_input, joined

InputInterpolation = Literal["zero", "linear", "smooth"]
INTERPOLATIONS: tuple[str, ...] = get_args(InputInterpolation)

# Coefficients of (ω/2)² / sin²(ω/2) as a series in the second difference: the inverse of the
# attenuation that joining samples by straight lines causes.
_STRAIGHT_LINES = (1.0, -1 / 12, 1 / 90, -1 / 560, 1 / 3150)


def at_steps(u: np.ndarray, substeps: int, how: InputInterpolation) -> np.ndarray:
    """Return the input (n,) at the start of each step and at the end, (n substeps + 1,).

    Several inputs are columns, here and there.

    ``zero`` holds a sample and ``linear`` joins samples by straight lines. ``smooth`` is for a
    band-limited input: a spline of degree five through the samples gives a point at each step, and
    the points are joined by straight lines, too, but shifted such that the lines have the spectrum
    of the input up to a quarter of the sampling rate. This needs no shorter steps. After the last
    sample the input is constant.
    """
    return joined([_of_one(each, substeps, how) for each in by_input(u)])


def _of_one(u: np.ndarray, substeps: int, how: InputInterpolation) -> np.ndarray:
    if how == "zero":
        return np.append(np.repeat(u, substeps), u[-1])
    places = np.minimum(np.arange(u.size * substeps + 1) / substeps, u.size - 1)
    if how == "linear":
        between: np.ndarray = np.interp(places, np.arange(u.size), u)
        return between
    points = map_coordinates(u, places[None], order=5, mode="nearest") if substeps > 1 else u
    shifted = _with_the_spectrum_of(points)
    return shifted if substeps > 1 else np.append(shifted, shifted[-1])


def _with_the_spectrum_of(u: np.ndarray) -> np.ndarray:
    points, difference = np.zeros(u.size), u
    for weight in _STRAIGHT_LINES:
        points = points + weight * difference
        difference = np.diff(np.pad(difference, 1, mode="edge"), 2)
    return points
