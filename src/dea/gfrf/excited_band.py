"""The spectrum of an input, which says at which frequencies a response is measured."""

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array

_SEGMENTS = 16  # of the record; half overlapping, so that 31 periodograms are averaged


def input_spectrum(u: ArrayLike, sampling_rate: float, frequencies: ArrayLike) -> Array:
    """Return the one-sided power spectral density of ``u`` at ``frequencies`` (Hz), by Welch.

    In input units squared per Hz; the mean of the input is not part of it.
    """
    from scipy.signal import welch

    signal = np.asarray(u, dtype=float)
    length = max(signal.size // _SEGMENTS, min(signal.size, 16))
    lines, density = welch(signal, sampling_rate, nperseg=length)
    found: Array = np.interp(np.abs(frequencies), lines, density)
    return found
