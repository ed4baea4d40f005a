"""What a record differs by from its right explanation: white noise, and an error of the law."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Error:
    """Gaussian error of an explanation: white, and coloured as an autoregression of first order.

    In the cosine basis such an error is nearly uncorrelated, with its spectral density for the
    variances (Whittle 1953, Arkiv för Matematik 2:423).

    Parameters
    ----------
    white, coloured
        Standard deviations, in the output's unit.
    memory
        Samples of the coloured error that count as one: the sum of its autocorrelation.
    """

    white: float
    coloured: float
    memory: float

    def at_least(self, coloured: float) -> "Error":
        """Return the same error with a coloured part of at least this size."""
        return replace(self, coloured=max(self.coloured, coloured))

    def deviations(self, samples: int) -> np.ndarray:
        """Return the standard deviation of each cosine of a record, shape (samples,)."""
        pole = (self.memory - 1.0) / (self.memory + 1.0)
        frequency = np.pi * np.arange(samples) / samples
        shape = (1.0 - pole**2) / (1.0 - 2.0 * pole * np.cos(frequency) + pole**2)
        result: np.ndarray = np.sqrt(self.white**2 + self.coloured**2 * shape)
        return result

    def whitened(self, signals: np.ndarray) -> np.ndarray:
        """Return signals, (n,) or (n, m), as uncorrelated numbers in units of the error."""
        from scipy.fft import dct

        scales = self.deviations(signals.shape[0])
        cosines = dct(signals, axis=0, norm="ortho")
        result: np.ndarray = (cosines.T / scales).T
        return result

    def log_determinant(self, samples: int) -> float:
        """Return the logarithm of the determinant of its covariance over a record."""
        return 2.0 * float(np.sum(np.log(self.deviations(samples))))
