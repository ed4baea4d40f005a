"""Input interpolation: what an input does between its samples."""

from functools import cache
from typing import Literal, get_args

import numpy as np
from scipy.interpolate import BSpline
from scipy.ndimage import spline_filter1d

from dea.inputs import by_input, joined

InputInterpolation = Literal["zero", "linear", "smooth"]
INTERPOLATIONS: tuple[str, ...] = get_args(InputInterpolation)

# Coefficients of (ω/2)² / sin²(ω/2) as a series in the second difference: the inverse of the
# attenuation that joining samples by straight lines causes.
_STRAIGHT_LINES = (1.0, -1 / 12, 1 / 90, -1 / 560, 1 / 3150)
# Degree of the spline through smooth samples, and for how many samples the input stands still
# before and after them: enough that the end conditions of the spline do not reach the record.
_DEGREE, _STILL = 5, 12


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
    if how == "linear":
        places = np.arange(u.size * substeps + 1) / substeps
        between: np.ndarray = np.interp(places, np.arange(u.size), u)
        return between
    if substeps == 1:
        shifted = _with_the_spectrum_of(u)
        return np.append(shifted, shifted[-1])
    return _with_the_spectrum_of(spline_points(u, substeps))


def spline_points(u: np.ndarray, substeps: int) -> np.ndarray:
    """Return the values of a spline through ``u`` (n,) at each step, (n substeps + 1,)."""
    still = np.pad(u, _STILL, mode="edge")
    first = _STILL - _DEGREE // 2
    coefficients = spline_filter1d(still, order=_DEGREE)[first : first + u.size + _DEGREE]
    steps = [np.convolve(coefficients, weights, mode="valid") for weights in _weights(substeps)]
    points = np.append(np.column_stack(steps), u[-1])
    points[-substeps:] = u[-1]
    return points


@cache
def _weights(substeps: int) -> np.ndarray:
    """Return the weights of the six coefficients about each step, the last one first."""
    half = 0.5 * (_DEGREE + 1)
    basis = BSpline.basis_element(np.arange(-half, half + 1), extrapolate=False)
    beyond = np.arange(half, -half, -1)
    weights: np.ndarray = np.nan_to_num(basis(np.arange(substeps)[:, None] / substeps - beyond))
    return weights


def _with_the_spectrum_of(u: np.ndarray) -> np.ndarray:
    points, difference = np.zeros(u.size), u
    for weight in _STRAIGHT_LINES:
        points = points + weight * difference
        difference = np.diff(np.pad(difference, 1, mode="edge"), 2)
    return points
