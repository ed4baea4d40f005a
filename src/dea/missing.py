"""Outputs of which some samples are missing: NaN where no good one was measured.

Inputs are known throughout. A missing output enters no estimate and no score: parameters come from
the stretches between missing ones, errors from the samples that are there. Only where a run needs
outputs to start from does the value interpolated between the neighbours take its place.
"""

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError

_SHORTEST = 3  # lags that a stretch holds at least


class ShortPartError(InputError):
    """A part is shorter than the lags take, however good its samples are."""


def filled(y: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return ``y`` with missing samples interpolated, and which samples were there, (samples,).

    Raises
    ------
    InputError
        Where none was.
    """
    seen = np.isfinite(y)
    if seen.all():
        return y, seen
    if not seen.any():
        raise InputError("every sample is missing", field="y", remedy="Record it again")
    at = np.arange(y.size)
    between = np.interp(at, at[seen], y[seen])
    if np.count_nonzero(seen) > 1:
        from scipy.interpolate import Akima1DInterpolator

        # A line misses the top of a curve by more than the noise of a good sensor.
        curve = Akima1DInterpolator(at[seen], y[seen], method="makima")(at)
        between = np.where(np.isfinite(curve), curve, between)
    return np.where(seen, y, between), seen


def runs(mask: NDArray[np.bool_]) -> list[slice]:
    """Return the contiguous runs of a ``mask`` (samples,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]]))).tolist()
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def stretches(seen: NDArray[np.bool_], part: slice, lag: int, terms: int = 0) -> list[slice]:
    """Return the stretches of ``part`` without a missing output, as slices of the record.

    Those too short for the largest ``lag`` and the number of ``terms`` are left out.

    Raises
    ------
    InputError
        Where there is none; :class:`ShortPartError` where the part is too short for any.
    """
    first = part.indices(seen.size)[0]
    shortest = max(_SHORTEST * lag, lag + terms) + 1
    found = [
        slice(first + run.start, first + run.stop)
        for run in runs(seen[part])
        if run.stop - run.start >= shortest
    ]
    if not found:
        last = part.indices(seen.size)[1] - 1
        if last - first + 1 < shortest:
            raise ShortPartError(
                f"samples {first} to {last} are {last - first + 1}, of which lags and terms take"
                f" {shortest}",
                field="y",
                remedy="Choose a longer part, or smaller lags",
            )
        raise InputError(
            f"samples {first} to {last} hold no {shortest} in a row that are good",
            field="y",
            remedy="Record it again, choose another part, or smaller lags",
        )
    return found
