"""The cost of a free run, and the model that its least squares are found by.

A Jacobian by finite differences takes a simulation for each parameter. It is computed where a fit
begins, where it has moved far, every few steps, and at its end; in between it follows the residual
by rank-one updates (Broyden 1965, Mathematics of Computation 19:577). Steps are corrected for the
curvature of the residual along them, which takes one simulation (Transtrum and Sethna 2012,
arXiv:1201.5885).
"""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import sensitivities
from dea.least_squares import Model, Point
from dea.simulation import ExtendedSimulation

# Part of the cost by which a step has to lower it for the Jacobian to be computed anew, and the
# iterations after which it is in any case.
_FAR, _REFRESH = 0.2, 4
# Prior spreads that a coordinate may move in one step.
_LONGEST_STEP = 3.0
# Part of a step at which its curvature is measured, and the length of a step, in prior spreads,
# from which on it is.
_PROBED, _SHORTEST = 0.1, 0.05
# Longest correction for the curvature, as a part of the step.
_BENT = 0.25


@dataclass(frozen=True)
class Columns:
    """How the columns of the Jacobian are obtained.

    Parameters
    ----------
    held : (k,) bool, optional
        Coordinates that stay where they start; their columns are zero, except those ``kept``.
    kept : (n, m), optional
        Columns for the first m coordinates that are used as they are, which saves simulations.
    """

    held: np.ndarray | None = None
    kept: np.ndarray | None = None


def cost_of(residual: np.ndarray, coordinates: np.ndarray, problem: Problem) -> float:
    """Return the sum of squares over the seen samples in units of the noise, plus the prior.

    It is infinite where the simulation runs away anywhere, on samples that are held out too.
    """
    if not np.isfinite(residual).all():
        return np.inf
    chosen = residual[problem.seen]
    return float(chosen @ chosen / problem.noise**2 + coordinates @ coordinates)


class FreeRun:
    """The cost of a free run, linearised; ``jacobian`` (n, k) is that of the last step.

    Of columns that are not kept, those of the last of so many ``iterations`` are computed anew.
    """

    def __init__(
        self, problem: Problem, extended: ExtendedSimulation, columns: Columns, iterations: int
    ) -> None:
        self._problem, self._extended, self._kept = problem, extended, columns.kept
        self._low, self._high = extended.bounds
        size = self._low.size
        self._free = np.ones(size, bool) if columns.held is None else ~columns.held
        self._last_iteration = iterations - 1
        self._linearised: Point[np.ndarray] | None = None
        self._updates = 0
        self.jacobian = np.zeros((problem.size, size))
        if columns.kept is not None:
            self.jacobian[:, : columns.kept.shape[1]] = columns.kept

    def evaluate(self, x: np.ndarray) -> Point[np.ndarray]:
        """Return the coordinates ``x`` within bounds, their cost and residual."""
        coordinates = np.clip(x, self._low, self._high)
        residual = self._problem.residual(self._extended, self._extended.values(coordinates))
        return Point(coordinates, cost_of(residual, coordinates, self._problem), residual)

    def linearise(self, point: Point[np.ndarray], iteration: int, exact: bool) -> Model | None:
        """Return the linearised cost at a point, None where the simulation runs away."""
        if not np.isfinite(point.value).all():
            return None
        anew = exact or iteration == self._last_iteration or self._is_far(point)
        self._follow(point, anew)
        x, noise, seen = point.x, self._problem.noise, self._problem.seen
        J = self.jacobian[seen] / noise
        A = J.T @ J + np.eye(x.size)
        g = J.T @ (point.value[seen] / noise) + x
        reach = np.where(self._free, _LONGEST_STEP, 0.0)
        low, high = np.maximum(self._low - x, -reach), np.minimum(self._high - x, reach)
        anywhere = np.where(self._free, np.inf, 0.0)

        def step(damping: float) -> np.ndarray:
            H = A + damping * np.diag(np.diag(A))
            straight = step_in_box(H, g, low, high)
            bend = self._bend(point, straight)
            if bend is None:
                return straight
            turn = step_in_box(H, J.T @ (bend[seen] / noise), -anywhere, anywhere)
            longest = _BENT * float(np.linalg.norm(straight))
            size = max(float(np.linalg.norm(turn)), 1e-300)
            corrected: np.ndarray = np.clip(straight + min(0.5, longest / size) * turn, low, high)
            return corrected

        # Kept columns are never computed anew, so that no more exact model exists.
        return Model(point.cost, step, exact=anew or self._kept is not None)

    def _is_far(self, point: Point[np.ndarray]) -> bool:
        """Return whether rank-one updates no longer serve at a point."""
        last = self._linearised
        if last is None or self._updates >= _REFRESH - 1:
            return True
        return last.cost - point.cost > _FAR * last.cost

    def _follow(self, point: Point[np.ndarray], anew: bool) -> None:
        """Compute the Jacobian at a point ``anew``, but for kept columns, or update it."""
        last, self._linearised = self._linearised, point
        kept = 0 if self._kept is None else self._kept.shape[1]
        if anew or last is None or kept:
            fresh = np.flatnonzero(self._free & (np.arange(self._free.size) >= kept))
            self.jacobian[:, fresh] = sensitivities(
                self._problem, self._extended, point.x, point.value, fresh
            )
            self._updates = 0
            return
        self._updates += 1
        moved = point.x - last.x
        if moved.any():
            error = point.value - last.value - self.jacobian @ moved
            self.jacobian += np.outer(error, moved / (moved @ moved))

    def _bend(self, point: Point[np.ndarray], step: np.ndarray) -> np.ndarray | None:
        """Return the second derivative of the residual along a step, (n,).

        None for a short step, in a fit with kept columns, or where the simulation runs away.
        """
        if self._kept is not None or np.linalg.norm(step) < _SHORTEST:
            return None
        ahead = self.evaluate(point.x + _PROBED * step).value
        if not np.isfinite(ahead).all():
            return None
        slope = self.jacobian @ step
        bend: np.ndarray = 2.0 / _PROBED * ((ahead - point.value) / _PROBED - slope)
        return bend


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
