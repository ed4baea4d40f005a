"""Fit parameters by free-run simulation: Levenberg-Marquardt with priors and bounds.

Levenberg (1944), Marquardt (1963); the prior makes it a maximum a posteriori estimate, which
keeps parameters that the record says nothing about where they were.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.problem import Problem
from dea.simulation import ExtendedSimulation

_STEP = 1e-3
_REFRESH = 3
# Damping after a row of good steps, small enough not to slow them, and how often it is raised
# tenfold before a step is given up: from the least to where a step is steepest descent.
_LEAST_DAMPING, _TRIES = 1e-6, 9
# Prior spreads that a coordinate may move in one step.
_LONGEST_STEP = 3.0


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted simulation: coordinates, what they leave over, and how well they are known.

    Each is equal to itself alone, so that it can be a key.

    Parameters
    ----------
    coordinates : (k,)
        Free parameters, in prior spreads from nominal.
    gap : (n,)
        Measured minus simulated output; infinite where the simulation is unstable.
    jacobian : (n, k)
        Derivative of the gap by the coordinates, at the last step.
    cost : float
        Sum of squares over the seen samples in units of the noise, plus the prior.
    """

    extended: ExtendedSimulation
    coordinates: np.ndarray
    gap: np.ndarray
    jacobian: np.ndarray
    cost: float

    @property
    def stable(self) -> bool:
        """Whether the simulation stays finite over the whole record."""
        return bool(np.isfinite(self.gap).all())

    @property
    def values(self) -> np.ndarray:
        """All parameter values."""
        return self.extended.values(self.coordinates)

    def covariance(self, samples: np.ndarray, variance: float) -> np.ndarray:
        """Return the covariance of the coordinates given white noise of ``variance``."""
        J = self.jacobian[samples]
        return np.linalg.inv(J.T @ J / variance + np.eye(J.shape[1]))


def cost_of(gap: np.ndarray, coordinates: np.ndarray, problem: Problem) -> float:
    """Return the sum of squares over the seen samples in units of the noise, plus the prior."""
    chosen = gap[problem.seen]
    if not np.isfinite(chosen).all():
        return np.inf
    return float(chosen @ chosen / problem.noise**2 + coordinates @ coordinates)


def columns(
    problem: Problem,
    extended: ExtendedSimulation,
    coordinates: np.ndarray,
    gap: np.ndarray,
    which: np.ndarray,
) -> np.ndarray:
    """Return the derivative of the gap by the coordinates ``which``, shape (n, len(which))."""
    _, high = extended.bounds
    reading = extended.only_read
    output = None
    if reading[which].any():
        output = problem.moved(extended, extended.values(coordinates))
    result = np.zeros((problem.u.size, which.size))
    for column, i in enumerate(which):
        moved = coordinates.copy()
        step = _STEP if moved[i] + _STEP <= high[i] else -_STEP
        moved[i] += step
        known = output if reading[i] else None
        change = problem.gap(extended, extended.values(moved), known) - gap
        # A direction in which the simulation runs away is not one to go.
        result[:, column] = change / step if np.isfinite(change).all() else 0.0
    return result


def remainder(J: np.ndarray, noise: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return what takes from a change of the output all that the parameters can make up for.

    A linear step in the parameters does so, held back by their prior; with the Jacobian (n, k) it
    turns changes of shape (n,) or (n, m) into what is left of them, with k rows of the prior below.
    """
    size = J.shape[1]
    basis, _ = np.linalg.qr(np.vstack([J, noise * np.eye(size)]))

    def left(change: np.ndarray) -> np.ndarray:
        padded = np.concatenate([change, np.zeros((size, *change.shape[1:]))])
        return padded - basis @ (basis.T @ padded)

    return left


def at(problem: Problem, extended: ExtendedSimulation, coordinates: np.ndarray) -> Fit:
    """Return the simulation as it is at ``coordinates``, with its Jacobian, unfitted."""
    gap = problem.gap(extended, extended.values(coordinates))
    J = np.zeros((problem.u.size, coordinates.size))
    if np.isfinite(gap).all():
        J = columns(problem, extended, coordinates, gap, np.arange(coordinates.size))
    return Fit(extended, coordinates, gap, J, cost_of(gap, coordinates, problem))


def without(problem: Problem, fitted: Fit, index: int) -> Fit:
    """Return a fitted simulation less one of its effects, all else as it was."""
    extended = fitted.extended.without(index)
    kept = np.delete(fitted.values, np.r_[fitted.extended.effect_slices[index]])
    return at(problem, extended, extended.coordinates(kept))


def fit(
    problem: Problem,
    extended: ExtendedSimulation,
    start: np.ndarray,
    *,
    iterations: int = 20,
    kept: np.ndarray | None = None,
    slow: int = 0,
    held: np.ndarray | None = None,
    tolerance: float = 1e-4,
) -> Fit:
    """Fit the free parameters from ``start`` on the samples the problem allows.

    Parameters
    ----------
    kept : (n, m), optional
        Columns of the Jacobian for the first m coordinates that are taken as they are, which
        makes a step cheaper; exact ones are computed otherwise.
    slow
        How many of the first coordinates have columns that are computed anew only every third
        step; the others change faster.
    held : (k,) bool, optional
        Coordinates that stay where they start.
    tolerance
        Stop when an accepted step lowers the cost by less than this part of it.
    """
    low, high = extended.bounds
    coordinates = np.clip(start, low, high)
    gap = problem.gap(extended, extended.values(coordinates))
    cost = cost_of(gap, coordinates, problem)
    size = coordinates.size
    free = np.ones(size, bool) if held is None else ~held
    J = np.zeros((problem.u.size, size))
    damping = 1e-3
    stalled = False
    for iteration in range(iterations):
        if not np.isfinite(cost) or not np.isfinite(gap).all():
            break
        whole = kept is None and (slow == 0 or iteration % _REFRESH == 0 or stalled)
        first = 0 if whole else slow if kept is None else kept.shape[1]
        if kept is not None:
            J[:, :first] = kept
        fresh = np.flatnonzero(free & (np.arange(size) >= first))
        J[:, fresh] = columns(problem, extended, coordinates, gap, fresh)
        chosen = J[problem.seen] / problem.noise
        A = chosen.T @ chosen + np.eye(size)
        g = chosen.T @ (gap[problem.seen] / problem.noise) + coordinates
        improved = False
        for _ in range(_TRIES):
            H = A + damping * np.diag(np.diag(A))
            reach = np.where(free, _LONGEST_STEP, 0.0)
            step = step_in_box(
                H, g, np.maximum(low - coordinates, -reach), np.minimum(high - coordinates, reach)
            )
            trial = np.clip(coordinates + step, low, high)
            trial_gap = problem.gap(extended, extended.values(trial))
            trial_cost = cost_of(trial_gap, trial, problem)
            if trial_cost < cost:
                improved = True
                damping = max(damping / 5.0, _LEAST_DAMPING)
                break
            damping *= 10.0
        gain = (cost - trial_cost) / cost if improved else 0.0
        if improved:
            coordinates, gap, cost = trial, trial_gap, trial_cost
        # Before giving up, old columns are computed anew: they may be what holds it up.
        if gain < tolerance and (whole or kept is not None):
            break
        stalled = gain < tolerance
    return Fit(extended, coordinates, gap, J, cost)


def step_in_box(H: np.ndarray, g: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the step s that makes g s + s H s / 2 least while ``low`` <= s <= ``high``.

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
