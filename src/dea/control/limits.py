"""Limits of the input that a controller gives."""

from typing import NamedTuple

from numba import njit


class InputLimits(NamedTuple):
    """Lowest and highest input, and its largest change from sample to sample."""

    lowest: float
    highest: float
    step: float


@njit(cache=True)
def limited(wanted: float, before: float, limits: InputLimits) -> float:
    """Return the input nearest to the one wanted, after the input of the sample before."""
    lowest, highest = before - limits.step, before + limits.step
    return min(max(wanted, limits.lowest, lowest), limits.highest, highest)
