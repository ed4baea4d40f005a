"""Deviations of a fit where its cost is steeper than the parabola that its curvature gives.

Two parameters that do the same at first order, such as the threshold of a dead zone and a jump at
it, are told apart by what they do beyond. The curvature knows nothing of that, and leaves both as
unsure as their priors.
"""

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem

# Standard deviations of a 95 % interval.
INTERVAL = 1.96
# Deviation, in prior spreads, up to which a cost counts as a parabola.
_SURE = 0.05
# Evaluations along a direction, and how far the cost may be from that at the end of the interval.
_TRIES, _CLOSE = 8, 0.1


def profiled(problem: Problem, fit: Fit, covariance: np.ndarray, variance: float) -> np.ndarray:
    """Return a ``covariance`` (k, k) of a fit's coordinates with shorter principal deviations.

    Each is shortened until the cost at the ends of its 95 % interval, in units of the ``variance``
    of the residual, is higher than that of the fit by no more than a normal distribution's: the
    profile likelihood along the direction (Venzon and Moolgavkar 1988, Applied Statistics 37:87).
    Of both sides the longer one counts, and none goes beyond the bounds. What is sure is left as it
    is, and so is a direction along which the cost is flatter than the parabola.
    """
    extended, centre = fit.extended, fit.coordinates
    low, high = extended.bounds

    def cost(coordinates: np.ndarray) -> float:
        residual = problem.residual(extended, extended.values(coordinates))[problem.seen]
        if not np.isfinite(residual).all():
            return np.inf
        return float(residual @ residual / variance + coordinates @ coordinates)

    lowest = cost(centre)

    def reach(way: np.ndarray) -> float:
        """Return the part of the way at whose end the cost has risen as it may."""
        part = 1.0
        for _ in range(_TRIES):
            rise = (cost(np.clip(centre + part * way, low, high)) - lowest) / INTERVAL**2
            if rise <= 1.0 + _CLOSE and (part == 1.0 or rise >= 1.0 - _CLOSE):
                break
            part *= float(np.clip(1.0 / np.sqrt(max(rise, 1e-6)), 0.1, 2.0))
            part = min(part, 1.0)
        return part

    lengths, axes = np.linalg.eigh(covariance)
    for k in np.flatnonzero(lengths > _SURE**2):
        way = INTERVAL * np.sqrt(lengths[k]) * axes[:, k]
        lengths[k] *= max(reach(way), reach(-way)) ** 2
    shortened: np.ndarray = (axes * lengths) @ axes.T
    return shortened
