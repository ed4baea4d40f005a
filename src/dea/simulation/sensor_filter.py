"""The known low-pass of a sensor, such as the anti-alias filter of its data sheet."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from dea.simulation.arguments import Reading
from dea.simulation.effects import low_pass_step

UNFILTERED = Reading(np.empty((0, 0)), np.empty((4, 0)))


@dataclass(frozen=True)
class SensorFilter:
    """A Butterworth low-pass between the output and its reading.

    Parameters
    ----------
    cutoff
        Where the gain has fallen by 3 dB, in Hz.
    order
        Number of its poles.
    """

    cutoff: float
    order: int = 2

    def over(self, step: float) -> Reading:
        """Return the filter over ``step`` seconds in which the output is a cubic polynomial."""
        return _over(self.order, 2.0 * np.pi * self.cutoff * step)


@cache
def _over(order: int, cutoff: float) -> Reading:
    """Return it for a cutoff in radians per step."""
    from scipy.signal import butter

    denominator = butter(order, cutoff, analog=True)[1]
    states, (level, slope, second, third) = low_pass_step(denominator / denominator[-1], 3)
    # The derivatives at its start of the cubic through values and rates at both ends (Hermite).
    end = 6.0 * second - 12.0 * third
    rates = (slope - 4.0 * second + 6.0 * third, 6.0 * third - 2.0 * second)
    gains = np.array([level - end, end, *rates])
    return Reading(np.ascontiguousarray(states), gains)
