"""The laser displacement sensor: anti-alias filter, range and noise."""

from typing import NamedTuple

from dea.arrays import Array
from dea.plant.film import SUBSTEP


class Sensor(NamedTuple):
    """The parameters of the sensor (SI units); an infinite ``cutoff`` means no filter."""

    cutoff: float
    noise: float
    range_low: float
    range_high: float


class AntiAliasFilter:
    """A second-order Butterworth low-pass at the sub-step rate, carried from call to call.

    Parameters
    ----------
    cutoff
        The -3 dB frequency in Hz.
    level
        The input before the first sample, always.
    """

    def __init__(self, cutoff: float, level: float) -> None:
        # Half a second to import, which an unfiltered sensor does not need.
        from scipy.signal import butter, sosfilt_zi

        self._sections = butter(2, cutoff, fs=1.0 / SUBSTEP, output="sos")
        self._memory = level * sosfilt_zi(self._sections)

    def advance(self, signal: Array) -> Array:
        """Return the next piece of the signal filtered, of the same shape."""
        from scipy.signal import sosfilt

        if not signal.size:
            return signal
        filtered: Array
        filtered, self._memory = sosfilt(self._sections, signal, zi=self._memory)
        return filtered
