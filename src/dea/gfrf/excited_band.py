"""The spectrum of an input, which says at which frequencies a response is measured."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array

_SEGMENTS = 16  # of the record; half overlapping, so that 31 periodograms are averaged


class InputSpectrum(NamedTuple):
    """The one-sided power spectral ``density`` of an input at ``lines`` (Hz), by Welch.

    In input units squared per Hz; the mean of the input is not part of it.
    """

    lines: Array
    density: Array

    @classmethod
    def of(cls, u: ArrayLike, sampling_rate: float) -> "InputSpectrum":
        """Return that of an input, shape (samples,)."""
        from scipy.signal import welch

        signal = np.asarray(u, dtype=float)
        length = max(signal.size // _SEGMENTS, min(signal.size, 16))
        return cls(*welch(signal, sampling_rate, nperseg=length))

    def at(self, frequencies: ArrayLike) -> Array:
        """Return the density at these frequencies (Hz)."""
        found: Array = np.interp(np.abs(frequencies), self.lines, self.density)
        return found
