"""Estimates of an effect's parameters, with intervals."""

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.report.verdict import Estimate


def estimates(problem: Problem, fit: Fit, index: int) -> dict[str, Estimate]:
    """Return the free parameters of the attached effect ``index`` with 95 % intervals.

    Those that the record determines best (relative to the prior) come first, those that only
    shape the law last.

    The autocorrelation of the residual widens the intervals: its variance is multiplied by the
    sum of its autocorrelation.
    """
    extended = fit.extended
    where = extended.effect_slices[index]
    parameters = extended.attached[index].parameters
    residual = fit.residual[problem.seen]
    variance = float(np.mean(residual**2)) * _inflation(residual)
    deviation = np.sqrt(np.diag(fit.covariance(problem.seen, variance)))
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


def _inflation(residual: np.ndarray) -> float:
    """Return the sum of the autocorrelation, up to its first zero crossing (Geyer 1992)."""
    spectrum = np.abs(np.fft.rfft(residual - residual.mean(), 2 * residual.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: residual.size // 4]
    correlation /= correlation[0] or 1.0
    crossing = int(np.argmax(correlation <= 0)) or correlation.size
    return 1.0 + 2.0 * float(np.sum(correlation[1:crossing]))
