"""The regressor matrix: the value of each term at each sample."""

from collections.abc import Sequence

import numpy as np

from dea.arrays import Array
from dea.inputs import by_input
from dea.narx.checks import check_inputs
from dea.terms import Term, max_lag, numbered_inputs


def regressor_matrix(terms: Sequence[Term], u: Array, y: Array, start: int | None = None) -> Array:
    """Return phi_j(x_t) of (2) for the samples from ``start`` on.

    Parameters
    ----------
    u, y
        Input and output, shape (samples,), in the model's own (normalised) units; several inputs
        are the columns of ``u``, shape (samples, inputs).
    start
        First row; by default the largest lag, the first sample with a complete past.

    Returns
    -------
    ndarray
        Shape (samples - start, terms), each column contiguous.
    """
    first = max_lag(terms) if start is None else start
    rows = max(y.size - first, 0)
    check_inputs(numbered_inputs(terms), u)
    inputs = by_input(u)
    matrix = np.ones((rows, len(terms)), order="F")
    for column, term in enumerate(terms):
        for lag in term.y_lags:
            matrix[:, column] *= y[first - lag : first - lag + rows]
        for source, lag in zip(term.input_columns, term.u_lags, strict=True):
            matrix[:, column] *= inputs[source, first - lag : first - lag + rows]
    return matrix
