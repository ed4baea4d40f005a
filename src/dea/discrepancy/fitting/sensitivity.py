"""Sensitivity of the simulated output to the parameters."""

from collections.abc import Callable

import numpy as np

from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem
from dea.simulation import ExtendedSimulation

# Step of the finite differences, in prior spreads.
_STEP = 1e-3


def sensitivities(
    problem: Problem,
    extended: ExtendedSimulation,
    coordinates: np.ndarray,
    residual: np.ndarray,
    which: np.ndarray,
) -> np.ndarray:
    """Return the derivative of the residual by the coordinates ``which``, (n, len(which)).

    ``residual`` (n,) is that at ``coordinates``. A coordinate in whose direction the simulation
    diverges has a derivative of zero, so that no step is made in it.
    """
    _, high = extended.layout.bounds
    values = extended.layout.values(coordinates)
    shaped = extended.shaped(values, problem.u, problem.interval) if which.size else None
    reading = extended.layout.only_read
    here = problem.moved(extended, values, shaped) if reading[which].any() else None

    def derivative(i: int) -> np.ndarray:
        moved = coordinates.copy()
        step = _STEP if moved[i] + _STEP <= high[i] else -_STEP
        moved[i] += step
        there = extended.layout.values(moved)
        output = here if reading[i] else problem.moved(extended, there, shaped)
        change = problem.residual(extended, there, output) - residual
        return change / step if np.isfinite(change).all() else np.zeros_like(change)

    columns = in_parallel(derivative, which, problem.threads)
    return np.array(columns).reshape(which.size, problem.size).T


def unabsorbed(J: np.ndarray, noise: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a function that takes from a change of the output what the parameters can absorb.

    They absorb it by a linear step that their prior limits. With the Jacobian (n, k) the function
    maps changes of shape (n,) or (n, m) to their remainders, with k rows of the prior below.
    """
    size = J.shape[1]
    basis, _ = np.linalg.qr(np.vstack([J, noise * np.eye(size)]))

    def remainder(change: np.ndarray) -> np.ndarray:
        padded = np.concatenate([change, np.zeros((size, *change.shape[1:]))])
        result: np.ndarray = padded - basis @ (basis.T @ padded)
        return result

    return remainder
