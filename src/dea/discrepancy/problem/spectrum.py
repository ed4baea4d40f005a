"""The power spectral density of a signal."""

import numpy as np


def spectrum(signal: np.ndarray, interval: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies in cycles per unit of ``interval``, and the density at each.

    The signal, shape (n,), is without its mean under Hann's window; the density is one-sided.
    """
    from scipy.signal import periodogram

    frequency, density = periodogram(signal, 1.0 / interval, window="hann")
    return frequency, density
