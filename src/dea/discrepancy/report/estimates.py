"""Estimates of an effect's parameters, with intervals."""

import numpy as np

from dea.discrepancy.evidence.model_error import ModelError, memory_of
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.report.verdict import Estimate


def estimates(
    problem: Problem, fit: Fit, index: int, spread: np.ndarray, error: ModelError
) -> dict[str, Estimate]:
    """Return the free parameters of the attached effect ``index`` with 95 % intervals.

    Those that the record determines best (relative to the prior) come first, those that only
    shape the law last.

    ``spread`` (k,) is the standard deviation of all coordinates from fits to parts of the record.
    The larger of it and of what the curvature of the cost gives counts, where the ``error`` of the
    law and the autocorrelation of the residual take part in the variance.
    """
    extended = fit.extended
    where = extended.effect_slices[index]
    parameters = extended.attached[index].parameters
    residual = fit.residual[problem.seen]
    variance = max(float(np.mean(residual**2)) * memory_of(residual), error.density)
    deviation = np.sqrt(np.diag(fit.covariance(problem.seen, variance)))
    deviation = np.maximum(deviation, spread)
    values = fit.values
    own = [k for k, i in enumerate(extended.free) if where.start <= i < where.stop]
    result = {}
    for position in sorted(own, key=lambda k: (extended.shapes[k], deviation[k])):
        i = extended.free[position]
        parameter = parameters[i - where.start]
        ends = [
            parameter.value(fit.coordinates[position] + side * 1.96 * deviation[position])
            for side in (-1.0, 1.0)
        ]
        value = float(values[i])
        result[parameter.name] = Estimate(value, parameter.unit, min(ends), max(ends))
    return result
