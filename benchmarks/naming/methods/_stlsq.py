"""Sequentially thresholded least squares: Brunton, Proctor and Kutz, PNAS 113 (2016) 3932."""

import numpy as np

from dea.arrays import Array

_ROUNDS = 20


def stlsq(G: Array, b: Array, threshold: float, ridge: float) -> Array:
    """Return sparse coefficients (m,) of columns X for a target y, given G = X'X and b = X'y.

    Coefficients of ridge regression below the ``threshold`` are set to zero and the others fitted
    again, until none falls; those left are fitted without the ridge. Columns and target should
    have one scale.
    """
    kept = np.ones(b.size, bool)
    for _ in range(_ROUNDS):
        found = np.zeros(b.size)
        found[kept] = np.linalg.solve(G[np.ix_(kept, kept)] + ridge * np.eye(kept.sum()), b[kept])
        large = np.abs(found) >= threshold
        if (large == kept).all():
            break
        kept = large
    coefficients = np.zeros(b.size)
    coefficients[kept] = np.linalg.lstsq(G[np.ix_(kept, kept)], b[kept], rcond=None)[0]
    return coefficients
