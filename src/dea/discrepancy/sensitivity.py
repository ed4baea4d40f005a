"""Sensitivity of the simulated output to the parameters."""

from collections.abc import Callable

import numpy as np

from dea.discrepancy.problem import Problem
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
    _, high = extended.bounds
    reading = extended.only_read
    output = None
    if reading[which].any():
        output = problem.moved(extended, extended.values(coordinates))
    result = np.zeros((problem.size, which.size))
    for column, i in enumerate(which):
        moved = coordinates.copy()
        step = _STEP if moved[i] + _STEP <= high[i] else -_STEP
        moved[i] += step
        known = output if reading[i] else None
        change = problem.residual(extended, extended.values(moved), known) - residual
        result[:, column] = change / step if np.isfinite(change).all() else 0.0
    return result


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
