"""What the best explanation leaves over: white noise, and a small coloured error of its laws."""

from dataclasses import dataclass

import numpy as np

from dea.autocovariance import autocovariance
from dea.discrepancy.rules import misfit


@dataclass(frozen=True)
class ModelError:
    """Levels of what no candidate explains, in the output's unit.

    Parameters
    ----------
    white
        Standard deviation of the white noise.
    left
        RMS that the best explanation leaves beyond it.
    coloured
        RMS of the error, correlated in time, that any explanation may have.
    memory
        Samples of the coloured error that count as one: the sum of its autocorrelation.
    """

    white: float
    left: float
    coloured: float
    memory: float

    @property
    def level(self) -> float:
        """RMS of all that the best explanation leaves."""
        return float(np.hypot(self.white, self.left))

    @property
    def density(self) -> float:
        """Variance that a sum of squares is divided by so that its differences are log-odds.

        It is the spectral density at low frequencies, where errors of laws lie.
        """
        return self.white**2 + self.memory * self.coloured**2


def model_error(
    before: np.ndarray, best: np.ndarray, noise: float, law_error: float, accuracy: float = 0.0
) -> ModelError:
    """Return the model error of a record, from the residuals of the simulation and the best fit.

    Parameters
    ----------
    before, best : (n,)
        Residuals of the simulation alone and of the best explanation, at the samples seen.
    noise
        White level, which quantisation bounds from below.
    law_error
        Part of the gap that a right effect's law leaves at least.
    accuracy
        Error that the simulation is stated to have with the effect in it, in the output's unit.
        It is one of laws, and correlated like theirs.
    """
    left = misfit(_rms(best), noise)
    expected = law_error * misfit(_rms(before), noise)
    # The smaller the error that is left, the less surely the residual shows its memory. An error
    # that is too small to be seen is given the memory of the residual of the simulation alone.
    sure = min(left / expected, 1.0) if expected > 0.0 else 1.0
    long, short = (_memory_beside(residual, noise) for residual in (before, best))
    return ModelError(
        noise, left, max(left, expected, accuracy), long ** (1.0 - sure) * short**sure
    )


def _memory_beside(residual: np.ndarray, noise: float) -> float:
    """Return the memory of a coloured error that white noise adds to."""
    whole = float(np.var(residual))
    own = whole - noise**2
    return max(1.0, (memory_of(residual) * whole - noise**2) / own) if own > 0 else 1.0


def memory_of(residual: np.ndarray, mean: float | None = None) -> float:
    """Return the sum of the autocorrelation, up to its first zero crossing (Geyer 1992).

    This is the number of correlated samples that count as one independent one. Localisation, which
    averages the energy of the residual, uses another number
    (:mod:`dea.discrepancy.evidence.localisation`).

    ``mean`` is that of the residual unless the expected one is given, as it must be where the
    residual is short compared with its memory.
    """
    centre = residual.mean() if mean is None else mean
    correlation = autocovariance(residual - centre, max(residual.size // 4, 1))
    correlation /= correlation[0] or 1.0
    crossing = int(np.argmax(correlation <= 0)) or correlation.size
    return 1.0 + 2.0 * float(np.sum(correlation[1:crossing]))


def _rms(residual: np.ndarray) -> float:
    return float(np.sqrt(np.mean(residual**2)))
