"""The laser displacement sensor: anti-alias filter, range and noise."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.plant.film import SUBSTEP


class Sensor(NamedTuple):
    """The parameters of the sensor (SI units)."""

    cutoff: float
    noise: float
    range_low: float
    range_high: float


def butterworth(cutoff: float) -> NDArray[np.float64]:
    """Return (b0, b1, b2, a1, a2) of a second-order Butterworth low-pass at the sub-step rate.

    ``cutoff`` is the -3 dB frequency in Hz; bilinear transform with the frequency prewarped
    (Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.2).
    """
    warped = np.tan(np.pi * cutoff * SUBSTEP)
    scale = 1.0 + np.sqrt(2.0) * warped + warped**2
    gain = warped**2 / scale
    feedback = 2.0 * (warped**2 - 1.0) / scale, (1.0 - np.sqrt(2.0) * warped + warped**2) / scale
    return np.array([gain, 2.0 * gain, gain, *feedback])


@njit(cache=True)
def low_pass(coefficients, memory, signal, filtered):
    """Filter ``signal`` into ``filtered``; ``memory``, shape (2,), is carried from call to call.

    Direct form II transposed.
    """
    b0, b1, b2, a1, a2 = coefficients
    for k in range(signal.shape[0]):
        value = b0 * signal[k] + memory[0]
        memory[0] = b1 * signal[k] - a1 * value + memory[1]
        memory[1] = b2 * signal[k] - a2 * value
        filtered[k] = value
    return filtered


def settled(coefficients: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Return the filter memory in which a constant ``level`` has always been the input."""
    _, b1, b2, a1, a2 = coefficients
    return np.array([(b1 + b2 - a1 - a2) * level, (b2 - a2) * level])
