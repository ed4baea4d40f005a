"""Deviations of a fit where its cost is steeper than the parabola that its curvature gives.

Two parameters that do the same at first order, such as the threshold of a dead zone and a jump at
it, are told apart by what they do beyond. The curvature knows nothing of that, and leaves both as
unsure as their priors.
"""

from collections.abc import Callable

import numpy as np

from dea.confidence import DEVIATIONS
from dea.discrepancy.fitting.fit import Fit, cost_of
from dea.discrepancy.problem.problem import Problem

# Deviation, in prior spreads, up to which a cost counts as a parabola.
_SURE = 0.05
# Evaluations along a way, how far the rise may be from one at its end, and above which rise it is
# shortened.
_TRIES, _CLOSE, _STEEP = 10, 0.1, 1.3
# Part of a way that bounds must leave for its side to count.
_OPEN = 0.5
# Variance, in those of the priors, from which a coordinate is a direction of its own: all such
# coordinates are nearly as unsure as each other, so that any mixture of them is principal.
# Otherwise a stop that is never reached would get the same deviation as a delay that is well told.
_HARDLY_TOLD = 0.99


def shortened(problem: Problem, fit: Fit, covariance: np.ndarray, variance: float) -> np.ndarray:
    """Return a ``covariance`` (k, k) of a fit's coordinates with shorter principal deviations.

    Each is shortened until the cost at the ends of its 95 % interval, in units of the ``variance``
    of the residual, exceeds that of the fit by as much as for a normal distribution: a cut through
    the cost, along which no other direction is fitted again. Coordinates stop at their bounds. The
    longer side counts; a side closed by bounds does not. A coordinate that the record hardly tells
    is shortened along its own axis instead of a principal direction. A direction that is well
    determined is left as it is, and so is one along which the cost is flatter than the parabola.
    """
    extended, centre = fit.extended, fit.coordinates
    low, high = extended.layout.bounds
    noisy = problem.with_noise(np.sqrt(variance))

    def cost(coordinates: np.ndarray) -> float:
        residual = noisy.residual(extended, extended.layout.values(coordinates))
        return cost_of(residual, coordinates, noisy)

    lowest = cost(centre)

    def one_side(way: np.ndarray) -> float:
        """Return the part of a way that the cost leaves; zero where bounds close it."""
        moved = np.clip(centre + way, low, high) - centre
        if np.linalg.norm(moved) < _OPEN * np.linalg.norm(way):
            return 0.0

        def rise(part: float) -> float:
            return (cost(np.clip(centre + part * way, low, high)) - lowest) / DEVIATIONS**2

        return _where_one(rise)

    def part_of(length: float, axis: np.ndarray) -> float:
        way = DEVIATIONS * np.sqrt(length) * axis
        # Where bounds close both sides, nothing is known against the length.
        return max(one_side(way), one_side(-way)) or 1.0

    result = covariance.copy()
    hardly_told = np.diag(covariance) >= _HARDLY_TOLD
    for k in np.flatnonzero(hardly_told):
        part = part_of(covariance[k, k], np.eye(len(covariance))[k])
        result[k] *= part
        result[:, k] *= part
    told = np.flatnonzero(~hardly_told)
    lengths, inside = np.linalg.eigh(covariance[np.ix_(told, told)])
    axes = np.zeros((told.size, len(covariance)))
    axes[:, told] = inside.T
    for length, axis in zip(lengths, axes, strict=True):
        if length > _SURE**2:
            result -= (1.0 - part_of(length, axis) ** 2) * length * np.outer(axis, axis)
    return result


def _where_one(rise: Callable[[float], float]) -> float:
    """Return the part of a way, up to the whole, where what rises along it reaches one.

    By false position in logarithms, between a part inside and one outside.
    """
    outside, above = 1.0, rise(1.0)
    if above <= _STEEP:
        return 1.0
    inside, below = 0.0, 0.0
    for _ in range(_TRIES):
        if inside == 0.0 or below <= 0.0 or not np.isfinite(above):
            part = np.sqrt(inside * outside) if inside else outside * max(above**-0.5, 0.1)
        else:
            slope = np.log(above / below) / np.log(outside / inside)
            part = inside * below ** (-1.0 / slope)
        found = rise(part)
        if abs(found - 1.0) <= _CLOSE:
            return float(part)
        if found > 1.0:
            outside, above = part, found
        else:
            inside, below = part, found
    return float(inside or outside)
