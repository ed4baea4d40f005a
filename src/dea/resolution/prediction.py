"""How well an explanation has predicted a further record, and what it learns from it."""

from typing import NamedTuple

import numpy as np

from dea.discrepancy import Samples, sensitivities
from dea.resolution.error import Error
from dea.resolution.explanation import Explanation, as_problem, triangle

# Evaluations at most; a search that has not ended by then makes the density look too small.
_ITERATIONS = 100
# Parts of the mean from which the search begins, until one does not diverge: the belief reaches
# where the record is described, though its mean may be just beyond.
_STARTS = (1.0, 0.9, 0.5, 0.0)
# Part of a prior spread by which a start is kept off its bounds.
_INSIDE = 1e-9


class Predicted(NamedTuple):
    """The logarithm of the density that a record had before it was seen, and what it tells."""

    log_density: float
    informed: Explanation


def predicted(explanation: Explanation, record: Samples, error: Error) -> Predicted:
    """Return the predictive density of a record under an explanation (Laplace's approximation).

    With the belief x ~ N(m, P) in the coordinates and the residual r(x), whitened by the error,

        log p = -(|r|² + (x - m)' P⁻¹ (x - m) + log |I + L' J' J L| + log |R| + n log 2π) / 2

    at the x that minimises the first two terms, where L L' = P and n counts the samples that are
    not missing. It is exact where the output is linear in x. It is zero where the simulation
    diverges at the mean and all the way to the nominal coordinates.
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import least_squares

    problem, extended = as_problem(record), explanation.extended
    known, samples = problem.known, int(np.count_nonzero(problem.known))
    every = np.arange(explanation.mean.size)
    L = explanation.root
    precise = solve_triangular(L, np.eye(every.size), lower=True)

    def residual(x: np.ndarray) -> np.ndarray:
        return problem.residual(extended, extended.layout.values(x))

    def cost(x: np.ndarray) -> np.ndarray:
        left = residual(x)
        bounded = np.isfinite(left).all()
        whitened = error.whitened(left, known) if bounded else np.full(samples, np.inf)
        return np.concatenate([whitened, precise @ (x - explanation.mean)])

    def slope(x: np.ndarray) -> np.ndarray:
        J = sensitivities(problem, extended, x, residual(x), every)
        return np.vstack([error.whitened(J, known), precise])

    low, high = extended.layout.bounds
    starts = [np.clip(k * explanation.mean, low + _INSIDE, high - _INSIDE) for k in _STARTS]
    start = next((x for x in starts if np.isfinite(residual(x)).all()), None)
    if start is None:
        return Predicted(-np.inf, explanation)
    scales = explanation.deviations
    found = least_squares(
        cost, start, jac=slope, bounds=(low, high), x_scale=scales, max_nfev=_ITERATIONS
    )
    J = found.jac[:samples]
    # |I + L'J'JL| is the square of the determinant of the triangle of this.
    grown = triangle(np.vstack([J @ L, np.eye(every.size)]))
    spread = 2.0 * float(np.sum(np.log(np.abs(np.diag(grown)))))
    total = 2.0 * found.cost + spread + error.log_determinant(known) + samples * np.log(2 * np.pi)
    return Predicted(-0.5 * float(total), explanation.informed(found.x, found.jac))
