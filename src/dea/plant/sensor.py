"""The laser displacement sensor: anti-alias filter, range and noise."""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.plant.array import Array
from dea.plant.film import SUBSTEP


class Sensor(NamedTuple):
    """The parameters of the sensor (SI units); an infinite ``cutoff`` means no filter."""

    cutoff: float
    noise: float
    range_low: float
    range_high: float


class AntiAliasFilter:
    """A second-order Butterworth low-pass at the sub-step rate, carried from call to call.

    Oppenheim and Schafer, Discrete-Time Signal Processing (2010), section 7.2: the bilinear
    transform of 1/(s^2 + sqrt(2) s + 1), with the cutoff where it is asked for.

    Parameters
    ----------
    cutoff
        The -3 dB frequency in Hz.
    level
        The input before the first sample, always.
    """

    def __init__(self, cutoff: float, level: float) -> None:
        # Not scipy.signal, which takes half a second to import.
        k = np.tan(np.pi * cutoff * SUBSTEP)
        share = 1.0 / (1.0 + np.sqrt(2.0) * k + k * k)
        gain = k * k * share
        back_1, back_2 = 2.0 * (k * k - 1.0) * share, (1.0 - np.sqrt(2.0) * k + k * k) * share
        self._coefficients = gain, back_1, back_2
        self._memory = level * np.array([1.0 - gain, gain - back_2])

    def advance(self, signal: Array) -> Array:
        """Return the next piece of the signal filtered, of the same shape."""
        return _filtered(*self._coefficients, self._memory, signal)


@njit(cache=True)
def _filtered(gain: float, back_1: float, back_2: float, memory: Array, signal: Array) -> Array:
    """Filter by (gain, 2 gain, gain) over (1, back_1, back_2), changing the memory (2,)."""
    filtered = np.empty_like(signal)
    for k in range(signal.shape[0]):
        y = memory[0] + gain * signal[k]
        memory[0] = memory[1] + 2.0 * gain * signal[k] - back_1 * y
        memory[1] = gain * signal[k] - back_2 * y
        filtered[k] = y
    return filtered
