"""How much of a residual a regression on given columns predicts where it was not fitted."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.problem import Problem, rmse

# Deviation on the samples fitted to, as a part of that on all, above which a column counts: what
# hardly changes there tells nothing of the others.
_TOLD = 1e-3


def part_predicted(
    problem: Problem, residual: np.ndarray, X: np.ndarray, ridges: Sequence[float]
) -> float:
    """Return the part of a ``residual`` (n,), in RMS, that columns ``X`` (n, m) predict.

    Weights are fitted to the samples with the role ``fit``; those with the role ``select`` judge,
    and take the best of the ``ridges``, which are parts of the columns' power.
    """
    train, test = problem.fit, problem.select
    e = residual - residual[train].mean()
    before = rmse(e, test)
    X = X[:, np.isfinite(X).all(axis=0)]
    X = X[:, X[train].std(axis=0) > _TOLD * X.std(axis=0)]
    if not before or not X.size:
        return 0.0
    X = (X - X[train].mean(0)) / X[train].std(0)
    gram, pull = X[train].T @ X[train], X[train].T @ e[train]
    identity = train.sum() * np.eye(X.shape[1])
    left = (rmse(e - X @ np.linalg.solve(gram + ridge * identity, pull), test) for ridge in ridges)
    return 1.0 - min(left) / before
