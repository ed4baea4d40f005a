"""The known low-pass of a sensor, such as the anti-alias filter of its data sheet."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from dea.simulation.effects import low_pass


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

    def read(self, output: np.ndarray, rate: np.ndarray, interval: float) -> np.ndarray:
        """Return an output (n,) behind the filter, exact where it is cubic between samples.

        They are ``interval`` seconds apart, and its rates (n,) at them are per second. It is at
        rest before the first.
        """
        polynomial = _polynomial(self.order, 2.0 * np.pi * self.cutoff * interval)
        return low_pass(output, polynomial, interval * rate)


@cache
def _polynomial(order: int, cutoff: float) -> tuple[float, ...]:
    """Return the denominator, which ends with one; ``cutoff`` is in radians per sample."""
    from scipy.signal import butter

    denominator = butter(order, cutoff, analog=True)[1]
    return tuple(denominator / denominator[-1])
