"""Estimate parameters by free-run simulation: least squares with priors and bounds.

The prior makes it a maximum a posteriori estimate: parameters that the record does not determine
keep their prior mean.
"""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fitting.sensitivity import sensitivities
from dea.discrepancy.problem.problem import Problem
from dea.least_squares import Damping, Model, Point, minimise
from dea.simulation import ExtendedSimulation, samples_of_each

# Iterations after which slowly changing columns of the Jacobian are computed anew.
_REFRESH = 3
# From the least damping, nine increases lead to one at which a step is steepest descent.
_DAMPING = Damping(fall=5.0, least=1e-6, tries=9)
# Distance from a bound, or from its prior mean, in prior spreads, at which a coordinate is there.
CLOSE = 1e-3
# Prior spreads that a coordinate may move in one step.
_LONGEST_STEP = 3.0


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
        return self.extended.layout.values(self.coordinates)

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


@dataclass(frozen=True)
class Columns:
    """How the columns of the Jacobian are obtained.

    Parameters
    ----------
    held : (k,) bool, optional
        Coordinates that stay where they start; their columns are zero, except those ``kept``.
    kept : (n, m), optional
        Columns for the first m coordinates that are used as they are, which saves simulations.
    slow
        Number of first coordinates whose columns are computed anew only every third step, and
        before the fit ends. Without ``kept`` only.
    """

    held: np.ndarray | None = None
    kept: np.ndarray | None = None
    slow: int = 0


def cost_of(residual: np.ndarray, coordinates: np.ndarray, problem: Problem) -> float:
    """Return the sum of squares over the seen samples in units of the noise, plus the prior.

    It is infinite where the simulation runs away anywhere, on samples that are held out too.
    """
    if not np.isfinite(residual).all():
        return np.inf
    chosen = residual[problem.seen]
    return float(chosen @ chosen / problem.noise**2 + coordinates @ coordinates)


def at_bounds(extended: ExtendedSimulation, coordinates: np.ndarray) -> np.ndarray:
    """Return which of the free coordinates (k,) are at a bound, shape (k,)."""
    low, high = extended.layout.bounds
    there: np.ndarray = (coordinates <= low + CLOSE) | (coordinates >= high - CLOSE)
    return there


def at_prior_bounds(fitted: Fit) -> list[str]:
    """Return the simulation's own parameters that are at a bound of their priors."""
    extended = fitted.extended
    own = len(extended.simulation.parameters)
    bound = extended.layout.free[at_bounds(extended, fitted.coordinates)]
    return [extended.layout.names[i] for i in bound if i < own]


def outside_priors(freed: Fit, declared: ExtendedSimulation) -> np.ndarray:
    """Return which free coordinates (k,) are own parameters outside their ``declared`` bounds.

    ``freed`` is a fit of the same simulation within wider ones.
    """
    low, high = declared.layout.bounds
    asked = declared.layout.coordinates(freed.values)
    own = declared.layout.free < len(declared.simulation.parameters)
    outside: np.ndarray = own & ((asked < low) | (asked > high))
    return outside


def at(problem: Problem, extended: ExtendedSimulation, coordinates: np.ndarray) -> Fit:
    """Return the simulation at ``coordinates``, with its Jacobian, without fitting it."""
    residual = problem.residual(extended, extended.layout.values(coordinates))
    J = np.zeros((problem.size, coordinates.size))
    if np.isfinite(residual).all():
        J = sensitivities(problem, extended, coordinates, residual, np.arange(coordinates.size))
    return Fit(extended, coordinates, residual, J, cost_of(residual, coordinates, problem))


def without(problem: Problem, fitted: Fit, index: int) -> Fit:
    """Return a fitted simulation without one of its effects, all else unchanged."""
    extended = fitted.extended.without(index)
    kept = np.delete(fitted.values, np.r_[fitted.extended.layout.effect_slices[index]])
    return at(problem, extended, extended.layout.coordinates(kept))


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
    task = _FreeRun(problem, extended, columns or Columns())
    point = minimise(task, start, _DAMPING, iterations=iterations, tolerance=tolerance)
    return Fit(extended, point.x, point.value, task.jacobian, point.cost)


class _FreeRun:
    """The cost of a free run, linearised by finite differences."""

    def __init__(self, problem: Problem, extended: ExtendedSimulation, columns: Columns) -> None:
        self._problem, self._extended, self._columns = problem, extended, columns
        self._low, self._high = extended.layout.bounds
        size = self._low.size
        self._free = np.ones(size, bool) if columns.held is None else ~columns.held
        self.jacobian = np.zeros((problem.size, size))
        if columns.kept is not None:
            self.jacobian[:, : columns.kept.shape[1]] = columns.kept
        self._weighed: tuple[np.ndarray, np.ndarray] | None = None

    def evaluate(self, x: np.ndarray) -> Point[np.ndarray]:
        coordinates = np.clip(x, self._low, self._high)
        residual = self._problem.residual(self._extended, self._extended.layout.values(coordinates))
        return Point(coordinates, cost_of(residual, coordinates, self._problem), residual)

    def linearise(self, point: Point[np.ndarray], iteration: int, exact: bool) -> Model | None:
        if not np.isfinite(point.value).all():
            return None
        x, residual = point.x, point.value
        kept, slow = self._columns.kept, self._columns.slow
        whole = kept is None and (slow == 0 or iteration % _REFRESH == 0 or exact)
        first = 0 if whole else slow
        if kept is not None:
            first = kept.shape[1]
        fresh = np.flatnonzero(self._free & (np.arange(x.size) >= first))
        noise, seen = self._problem.noise, self._problem.seen
        if fresh.size or self._weighed is None:
            self.jacobian[:, fresh] = sensitivities(
                self._problem, self._extended, x, residual, fresh
            )
            J = self.jacobian[seen] / noise
            self._weighed = J, J.T @ J + np.eye(x.size)
        J, A = self._weighed
        g = J.T @ (residual[seen] / noise) + x
        reach = np.where(self._free, _LONGEST_STEP, 0.0)
        low, high = np.maximum(self._low - x, -reach), np.minimum(self._high - x, reach)

        def step(damping: float) -> np.ndarray:
            return step_in_box(A + damping * np.diag(np.diag(A)), g, low, high)

        # Kept columns are never computed anew, so that no more exact model exists.
        return Model(point.cost, step, exact=whole or kept is not None)


def step_in_box(H: np.ndarray, g: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the step s that minimises g s + s H s / 2 within ``low`` <= s <= ``high``.

    Parameters
    ----------
    H : (k, k)
        Positive definite.
    g, low, high : (k,)
        Gradient and bounds; a coordinate whose bounds are equal stays.
    """
    from scipy.linalg import cholesky, solve_triangular
    from scipy.optimize import lsq_linear

    step = np.zeros(g.size)
    inside = high > low
    root = cholesky(H[np.ix_(inside, inside)])
    pull = -solve_triangular(root, g[inside], trans="T")
    free = solve_triangular(root, pull)
    bounds = low[inside], high[inside]
    if (free < bounds[0]).any() or (free > bounds[1]).any():
        free = lsq_linear(root, pull, bounds, method="bvls").x
    step[inside] = free
    return step
