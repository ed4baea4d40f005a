"""The regressor matrix: the value of each term at each sample."""

from collections.abc import Sequence

import numpy as np

from dea.narx.checks import Array
from dea.terms import Term, max_lag


def regressor_matrix(terms: Sequence[Term], u: Array, y: Array, start: int | None = None) -> Array:
    """Return phi_j(x_t) of (2) for the samples from ``start`` on.

    Parameters
    ----------
    u, y
        Input and output, shape (samples,), in the model's own (normalised) units.
    start
        First row; by default the largest lag, the first sample with a complete past.

    Returns
    -------
    ndarray
        Shape (samples - start, terms), each column contiguous.
    """
    first = max_lag(terms) if start is None else start
    rows = max(y.size - first, 0)
    matrix = np.ones((rows, len(terms)), order="F")
    for column, term in enumerate(terms):
        for signal, lags in ((y, term.y_lags), (u, term.u_lags)):
            for lag in lags:
                matrix[:, column] *= signal[first - lag : first - lag + rows]
    return matrix
