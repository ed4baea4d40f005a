"""Estimate parameters by free-run simulation: least squares with priors and bounds.

The prior makes it a maximum a posteriori estimate: parameters that the record does not determine
keep their prior mean.
"""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.free_run import Columns, FreeRun, cost_of
from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import sensitivities
from dea.least_squares import Damping, minimise
from dea.simulation import TIMING_OFFSET, ExtendedSimulation, samples_of_each

# From the least damping, nine increases lead to one at which a step is steepest descent.
_DAMPING = Damping(fall=5.0, least=1e-6, tries=9)
# Difference of costs, in squares of the assumed noise, below which two fits count as equally good.
_AS_GOOD = 3.84
# Distance from a bound, or from its prior mean, in prior spreads, at which a coordinate is there.
CLOSE = 1e-3


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted simulation: coordinates, residual, and their sensitivities.

    Compared by identity, so that it can be a key.

    Parameters
    ----------
    coordinates : (k,)
        Free parameters, in prior spreads from nominal.
    residual : (n,)
        Measured minus simulated output; infinite where the simulation is unstable.
    jacobian : (n, k)
        Derivative of the residual by the coordinates, at the last step.
    cost : float
        Sum of squares over the seen samples in units of the noise, plus the prior.
    """

    extended: ExtendedSimulation
    coordinates: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    cost: float

    @property
    def stable(self) -> bool:
        """Whether the simulation stays finite over the whole record."""
        return bool(np.isfinite(self.residual).all())

    @property
    def values(self) -> np.ndarray:
        """All parameter values."""
        return self.extended.values(self.coordinates)

    @property
    def records(self) -> list[slice]:
        """The samples of each record."""
        return samples_of_each(self.extended.lengths or (self.residual.size,))

    def freedom(self, samples: np.ndarray, noise: float) -> float:
        """Return the trace of the matrix that maps the record to its fit, given the noise."""
        J = self.jacobian[samples] / noise
        told = np.maximum(np.linalg.eigvalsh(J.T @ J), 0.0)
        return float(np.sum(told / (1.0 + told)))

    def covariance(self, samples: np.ndarray, variance: float) -> np.ndarray:
        """Return the covariance of the coordinates given white noise of ``variance``."""
        J = self.jacobian[samples]
        return np.linalg.inv(J.T @ J / variance + np.eye(J.shape[1]))


def at_bounds(extended: ExtendedSimulation, coordinates: np.ndarray) -> np.ndarray:
    """Return which of the free coordinates (k,) are at a bound, shape (k,)."""
    low, high = extended.bounds
    there: np.ndarray = (coordinates <= low + CLOSE) | (coordinates >= high - CLOSE)
    return there


def beyond_priors(fitted: Fit) -> list[str]:
    """Return the simulation's own parameters that are at a bound of their priors."""
    extended = fitted.extended
    own = len(extended.simulation.parameters)
    bound = extended.free[at_bounds(extended, fitted.coordinates)]
    return [extended.names[i] for i in bound if i < own]


def at(problem: Problem, extended: ExtendedSimulation, coordinates: np.ndarray) -> Fit:
    """Return the simulation at ``coordinates``, with its Jacobian, without fitting it."""
    residual = problem.residual(extended, extended.values(coordinates))
    J = np.zeros((problem.size, coordinates.size))
    if np.isfinite(residual).all():
        J = sensitivities(problem, extended, coordinates, residual, np.arange(coordinates.size))
    return Fit(extended, coordinates, residual, J, cost_of(residual, coordinates, problem))


def without(problem: Problem, fitted: Fit, index: int) -> Fit:
    """Return a fitted simulation without one of its effects, all else unchanged."""
    extended = fitted.extended.without(index)
    kept = np.delete(fitted.values, np.r_[fitted.extended.effect_slices[index]])
    return at(problem, extended, extended.coordinates(kept))


def fit(
    problem: Problem,
    extended: ExtendedSimulation,
    start: np.ndarray,
    *,
    iterations: int = 20,
    tolerance: float = 1e-4,
    columns: Columns | None = None,
) -> Fit:
    """Fit the free parameters from ``start`` (k,) to the samples that the problem allows.

    Ends after ``iterations``, or when a step lowers the cost by no more than ``tolerance`` (a
    part of it).
    """
    task = FreeRun(problem, extended, columns or Columns(), iterations)
    point = minimise(task, start, _DAMPING, iterations=iterations, tolerance=tolerance)
    return Fit(extended, point.x, point.value, task.jacobian, point.cost)


def on_whole_record(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit estimated again on all samples, the certified ones too.

    Where an effect explains the record as well without a timing offset, there is none: a delay or
    a lag then counts in full.
    """
    whole = problem.whole()
    free = fit(whole, fitted.extended, fitted.coordinates)
    names = [fitted.extended.names[i] for i in fitted.extended.free]
    if TIMING_OFFSET not in names:
        return free
    timing = np.array([name == TIMING_OFFSET for name in names])
    start = np.where(timing, 0.0, free.coordinates)
    held = fit(whole, fitted.extended, start, columns=Columns(held=timing))
    return held if held.cost <= free.cost + _AS_GOOD else free
