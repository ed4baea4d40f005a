"""Held-out residuals: of each block, by parameters that were not fitted to it."""

import numpy as np

from dea.discrepancy.evidence.split import runs
from dea.discrepancy.fit import Columns, Fit, fit
from dea.discrepancy.problem import Problem

# Parts of the blocks that are held out in turn, and steps of the fit to the others, from where the
# fit to all of them ended.
_FOLDS, _ITERATIONS = 6, 6


class HeldOut:
    """Held-out residuals of fits, each computed once.

    The blocks are dealt into folds, and each is predicted by a fit to all others (Geisser 1975,
    cross-validation). The parameters change so little that the Jacobian of the fit to all is used.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._found: dict[Fit, np.ndarray] = {}

    def residual(self, fitted: Fit) -> np.ndarray:
        """Return the held-out residual of a fit, shape (n,)."""
        if fitted not in self._found:
            self._found[fitted] = self._cross_validated(fitted)
        return self._found[fitted]

    def rmse(self, fitted: Fit) -> float:
        """Return its root mean square over the seen samples."""
        return self._problem.seen_rmse(self.residual(fitted))

    def _cross_validated(self, fitted: Fit) -> np.ndarray:
        result = fitted.residual.copy()
        for fold in folds(self._problem):
            again = fit(
                self._problem.seeing(~fold),
                fitted.extended,
                fitted.coordinates,
                iterations=_ITERATIONS,
                columns=Columns(kept=fitted.jacobian),
            )
            result[fold] = again.residual[fold]
        return result


def folds(problem: Problem) -> list[np.ndarray]:
    """Return masks (n, bool) to which the contiguous seen blocks are dealt in turn."""
    blocks = runs(problem.seen)
    result = []
    for first in range(min(_FOLDS, len(blocks))):
        mask = np.zeros(problem.u.size, bool)
        for block in blocks[first::_FOLDS]:
            mask[block] = True
        result.append(mask)
    return result
