"""The compiled step of the tracker that runs beside a device."""

import numpy as np
from numba import njit

from dea.arrays import Array, Indices
from dea.narx import NONE
from dea.tracking import RlsState, update


@njit(cache=True, error_model="numpy")
def step(
    U: Array,
    z: Array,
    V: Array,
    theta: Array,
    sums: Array,
    row: Array,
    past: Array,
    y_lags: Indices,
    u_lags: Indices,
    scale: Array,
    target: Array,
    forgetting: float,
    leakage: float,
    u: float,
    y: float,
    complete: bool,
) -> float:
    """Pass a sample through the recursion and into the past, in place.

    Arrays are given one by one, since numba takes longer to look into a tuple than for the step.

    Parameters
    ----------
    U, z, V, theta, sums, row
        Those of :class:`dea.tracking.RlsState`.
    past
        Of lag k, in column k - 1: u, y, NaN where it was not measured, and y with the prediction in
        its place; shape (3, lags).
    y_lags, u_lags
        Of each term, (terms, most factors).
    scale, target
        Of the regressors; what the leakage pulls to, for scaled regressors; (terms,).
    u, y
        This sample in the units of the equation; an output that is missing is NaN.
    complete
        Whether the past reaches back to the largest lag.

    Returns
    -------
    float
        The error of the prediction, NaN where a measured value is missing.
    """
    state = RlsState(U, z, V, theta, sums, row)
    inputs, measured, filled = past[0], past[1], past[2]
    terms = scale.size
    phi = np.empty(terms)
    predicted, known = 0.0, np.isfinite(y)
    for j in range(terms):
        product, seen = 1.0, 1.0
        for factor in range(u_lags.shape[1]):
            lag = u_lags[j, factor]
            if lag == NONE:
                break
            value = inputs[lag - 1] if lag else u
            product *= value
            seen *= value
        for factor in range(y_lags.shape[1]):
            lag = y_lags[j, factor]
            if lag == NONE:
                break
            product *= filled[lag - 1]
            seen *= measured[lag - 1]
        known &= np.isfinite(seen)
        phi[j] = seen / scale[j]
        predicted += theta[j] * product / scale[j]
    innovation = np.nan
    if complete:
        innovation = update(state, phi, y if known else np.nan, forgetting, leakage, target)
    for k in range(inputs.size - 1, 0, -1):
        inputs[k], measured[k], filled[k] = inputs[k - 1], measured[k - 1], filled[k - 1]
    inputs[0], measured[0] = u, y
    filled[0] = y if np.isfinite(y) else predicted
    return innovation
