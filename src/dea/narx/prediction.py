"""Predictions a fixed number of samples ahead of the last measured output."""

from collections.abc import Sequence

import numpy as np

from dea.arrays import Array
from dea.inputs import by_input
from dea.narx.regressors import regressor_matrix
from dea.narx.scaling import Scaling
from dea.terms import Term, max_lag


def predicted(
    terms: Sequence[Term], parameters: Array, scaling: Scaling, u: Array, y: Array, steps: int
) -> Array:
    """Return the prediction of each sample from the outputs measured ``steps`` samples before it.

    All starts go one sample ahead together: the lags that are still unmeasured then hold what was
    predicted from the same start.

    Parameters
    ----------
    u, y
        In physical units, shape (samples,), NaN where an output is missing; several inputs are
        the columns of ``u``.

    Returns
    -------
    ndarray
        In physical units, shape (samples,), the first ``max_lag + steps - 1`` as measured.
    """
    lag = max_lag(terms)
    inputs, outputs = scaling.normalise_input(u), scaling.normalise_output(y)
    first = lag + steps - 1
    if steps == 1:
        ahead = regressor_matrix(terms, inputs, outputs) @ parameters
    else:
        # Row j holds the outputs that the start at sample j knows: lags before it, then its run.
        starts, rows = np.arange(lag, y.size - steps + 1), by_input(inputs)
        known = outputs[starts[:, None] - lag + np.arange(lag)]
        for step in range(steps):
            at = starts + step
            value = np.zeros(starts.size)
            for term, parameter in zip(terms, parameters, strict=True):
                product = np.full(starts.size, float(parameter))
                for k in term.y_lags:
                    product = product * known[:, -k]
                for source, k in zip(term.input_columns, term.u_lags, strict=True):
                    product = product * rows[source, at - k]
                value += product
            known = np.column_stack([known, value])
        ahead = known[:, -1]
    return np.concatenate([y[:first], scaling.restore_output(ahead)])
