"""Limits of the input that a controller gives."""

from math import inf
from typing import NamedTuple

from numba import njit

from dea.errors import InputError


def are_limits(lowest: float, highest: float) -> bool:
    """Tell whether both are finite and the first is the lower one."""
    return -inf < lowest < highest < inf


class InputLimits(NamedTuple):
    """Lowest and highest input, and its largest change from sample to sample."""

    lowest: float
    highest: float
    step: float

    def check(self) -> None:
        """Refuse limits that are not finite or leave no input to choose."""
        if not (are_limits(self.lowest, self.highest) and self.step > 0.0):
            raise InputError(
                f"inputs from {self.lowest:g} to {self.highest:g}, {self.step:g} per sample",
                field="limits",
                remedy="Give finite limits that rise, and a positive change per sample.",
            )


@njit(cache=True)
def limited(wanted: float, before: float, limits: InputLimits) -> float:
    """Return the input nearest to the one wanted, after the input of the sample before."""
    lowest, highest = before - limits.step, before + limits.step
    return min(max(wanted, limits.lowest, lowest), limits.highest, highest)
