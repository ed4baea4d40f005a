"""What a record differs by from its right explanation: white noise, and an error of the law."""

from dataclasses import dataclass, replace

import numpy as np

from dea.resolution.innovations import innovation_variances, innovations

# Ratio of the memories of neighbouring parts of the coloured error, at most.
_RATIO = 3.0


@dataclass(frozen=True)
class Error:
    """Gaussian error of an explanation: white, and coloured.

    A law that is not quite right errs where the device moves fast and where it moves slowly. The
    coloured part is therefore a sum of autoregressions of first order with the same variance, whose
    memories are in equal ratios (Keshner 1982, Proceedings of the IEEE 70:212). In the cosine basis
    such an error is nearly uncorrelated, with its spectral density for the variances (Whittle 1953,
    Arkiv för Matematik 2:423).

    Parameters
    ----------
    white, coloured
        Standard deviations, in the output's unit.
    memory
        Samples of its slowest part that count as one: the sum of its autocorrelation.
    fastest
        The same of its fastest part.
    """

    white: float
    coloured: float
    memory: float
    fastest: float = 1.0

    def at_least(self, coloured: float) -> "Error":
        """Return the same error with a coloured part of at least this size."""
        return replace(self, coloured=max(self.coloured, coloured))

    def deviations(self, samples: int) -> np.ndarray:
        """Return the standard deviation of each cosine of a record, shape (samples,)."""
        pole = self._poles
        cosine = np.cos(np.pi * np.arange(samples) / samples)[:, None]
        shapes = (1.0 - pole**2) / (1.0 - 2.0 * pole * cosine + pole**2)
        result: np.ndarray = np.sqrt(self.white**2 + self.coloured**2 * shapes.mean(axis=1))
        return result

    @property
    def memories(self) -> np.ndarray:
        """Memories (k,) of the parts of the coloured error, in samples."""
        parts = 1 + int(np.ceil(np.log(self.memory / self.fastest) / np.log(_RATIO)))
        return np.geomspace(self.fastest, self.memory, parts)

    @property
    def _poles(self) -> np.ndarray:
        return (self.memories - 1.0) / (self.memories + 1.0)

    def whitened(self, signals: np.ndarray, known: np.ndarray | None = None) -> np.ndarray:
        """Return signals, (n,) or (n, m), as uncorrelated numbers in units of the error.

        Where some samples are not ``known`` (n, bool), as many numbers as there are known ones:
        their innovations.
        """
        from scipy.fft import dct

        if known is not None and not known.all():
            variances, gains = self._filter(known)
            columns = signals.reshape(signals.shape[0], -1).astype(float)
            found = innovations(columns, known, gains, self._poles)
            found /= np.sqrt(variances[known])[:, None]
            return found.reshape(-1, *signals.shape[1:])
        scales = self.deviations(signals.shape[0])
        cosines = dct(signals, axis=0, norm="ortho")
        result: np.ndarray = (cosines.T / scales).T
        return result

    def spread(self, signals: np.ndarray) -> np.ndarray:
        """Return S (n, m) with SᵀS = XᵀΩX, for signals X and the covariance Ω of the error."""
        from scipy.fft import dct

        cosines = dct(signals, axis=0, norm="ortho")
        result: np.ndarray = cosines * self.deviations(signals.shape[0])[:, None]
        return result

    def at_rate(self, factor: int) -> "Error":
        """Return the same error in a record that is sampled ``factor`` times as fast."""
        return replace(self, memory=factor * self.memory, fastest=factor * self.fastest)

    def log_determinant(self, known: np.ndarray) -> float:
        """Return the logarithm of the determinant of its covariance at known samples (n, bool)."""
        if not known.all():
            return float(np.sum(np.log(self._filter(known)[0][known])))
        return 2.0 * float(np.sum(np.log(self.deviations(known.size))))

    def _filter(self, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        poles = self._poles
        coloured = np.full(poles.size, self.coloured**2 / poles.size)
        return innovation_variances(known, self.white**2, coloured, poles)
