"""The products of a signal with itself, by Fourier transforms."""

import numpy as np

from dea.arrays import Array


def autocovariance(centred: Array, lags: int) -> Array:
    """Return the sums of products of a signal (n,) and itself at lags below ``lags``.

    Samples beyond its ends count as zeros: as many are appended as keep the ends apart.
    """
    spectrum = np.abs(np.fft.rfft(centred, 2 * centred.size)) ** 2
    products: Array = np.fft.irfft(spectrum)[:lags]
    return products
