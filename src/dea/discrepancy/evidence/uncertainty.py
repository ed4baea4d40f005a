"""How sure the coordinates of a fit are."""

from typing import NamedTuple

import numpy as np

from dea.discrepancy.evidence.model_error import ModelError, memory_of
from dea.discrepancy.evidence.steepness import shortened
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem


class Uncertainty(NamedTuple):
    """Standard deviations (k,) and covariance (k, k) of the coordinates of a fit."""

    deviation: np.ndarray
    covariance: np.ndarray


def uncertainty(problem: Problem, fit: Fit, spread: np.ndarray, error: ModelError) -> Uncertainty:
    """Return how sure the coordinates of a fit are.

    ``spread`` (k,) is their standard deviation from fits to parts of the record. The larger of it
    and of what the cost gives counts (:func:`shortened`), where the autocorrelation of the residual
    takes part in the variance; correlations are those of the cost. The ``error`` of the law
    may be of one sign over the whole record, since another form of the law shifts its defining
    parameter, such as a limit.
    """
    residual = fit.residual[problem.seen]
    of_law = error.white**2 + residual.size * error.coloured**2
    variance = max(float(np.mean(residual**2)) * memory_of(residual), of_law)
    covariance = shortened(problem, fit, fit.covariance(problem.seen, variance), variance)
    own = np.sqrt(np.diag(covariance))
    deviation = np.maximum(own, spread)
    factor = deviation / own
    return Uncertainty(deviation, covariance * np.outer(factor, factor))
