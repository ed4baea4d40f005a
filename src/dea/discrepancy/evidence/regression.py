"""How much of a residual a regression on given columns predicts where it was not fitted.

Weights are fitted to the samples with the role ``fit``; those with the role ``select`` judge.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.discrepancy.problem.problem import Problem, rmse

# Deviation on the samples fitted to, as a part of that on all, above which a column counts: what
# hardly changes there tells nothing of the others.
_TOLD = 1e-3


class Standardised(NamedTuple):
    """Columns (n, m) with a mean of zero and a deviation of one on the samples fitted to.

    ``kept`` are the places that they had, without those that are not finite or hardly change there.
    """

    columns: np.ndarray
    kept: np.ndarray
    mean: np.ndarray
    scale: np.ndarray


def standardised(problem: Problem, X: np.ndarray) -> Standardised:
    """Return the columns of ``X`` (n, m) that can be fitted, on one scale."""
    train = problem.fit
    finite = np.flatnonzero(np.isfinite(X).all(axis=0))
    told = X[:, finite][train].std(axis=0) > _TOLD * X[:, finite].std(axis=0)
    kept = finite[told]
    X = X[:, kept]
    mean, scale = X[train].mean(axis=0), X[train].std(axis=0)
    return Standardised((X - mean) / scale, kept, mean, scale)


def least_left(problem: Problem, e: np.ndarray, X: np.ndarray, ridges: Sequence[float]) -> float:
    """Return the RMS that standardised columns ``X`` (n, m) leave of ``e`` (n,), at least.

    The best of the ``ridges`` counts, which are parts of the columns' power (ridge regression:
    Hoerl and Kennedy 1970). No columns leave it as it is.
    """
    train, test = problem.fit, problem.select
    gram, pull = X[train].T @ X[train], X[train].T @ e[train]
    identity = train.sum() * np.eye(X.shape[1])
    weights = (np.linalg.solve(gram + ridge * identity, pull) for ridge in ridges)
    return min(rmse(e - X @ each, test) for each in weights)


def part_predicted(
    problem: Problem, residual: np.ndarray, X: np.ndarray, ridges: Sequence[float]
) -> float:
    """Return the part of a ``residual`` (n,), in RMS, that columns ``X`` (n, m) predict."""
    e = residual - residual[problem.fit].mean()
    before = rmse(e, problem.select)
    if not before:
        return 0.0
    return 1.0 - least_left(problem, e, standardised(problem, X).columns, ridges) / before
