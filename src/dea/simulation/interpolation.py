"""Input interpolation: what an input does between its samples."""

from typing import Literal, get_args

import numpy as np

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
    band-limited input: it joins points by straight lines, too, but shifts the points such that
    the lines have the spectrum of the input up to a quarter of the sampling rate. This needs no
    shorter steps. After the last sample the input is constant.
    """
    return joined([_of_one(each, substeps, how) for each in by_input(u)])


def _of_one(u: np.ndarray, substeps: int, how: InputInterpolation) -> np.ndarray:
    if how == "zero":
        return np.append(np.repeat(u, substeps), u[-1])
    points = _with_the_spectrum_of(u) if how == "smooth" else u
    result: np.ndarray = np.interp(
        np.arange(u.size * substeps + 1) / substeps, np.arange(u.size), points
    )
    return result


def _with_the_spectrum_of(u: np.ndarray) -> np.ndarray:
    points, difference = np.zeros(u.size), u
    for weight in _STRAIGHT_LINES:
        points = points + weight * difference
        difference = np.diff(np.pad(difference, 1, mode="edge"), 2)
    return points
