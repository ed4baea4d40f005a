"""The compiled step of the plan: a model's free run, its slopes, and one Gauss-Newton step."""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array, Indices
from dea.control.limits import InputLimits, limited
from dea.narx import NONE

# Times the largest output wanted, and one in the units of the equation at least: no plan that
# follows comes near it, and products of a few such outputs are far from overflow.
DIVERGED = 1e3


class Equation(NamedTuple):
    """Parameters (terms,) of a model, and its lags (terms, most factors), padded with ``NONE``."""

    theta: Array
    y_lags: Indices
    u_lags: Indices


@njit(cache=True, error_model="numpy")
def output_and_slopes(equation: Equation, y: Array, u: Array, t: int, a: Array, b: Array) -> float:
    """Return y_t of the model, and write its slopes: a_k by y_{t-k}, b_k by u_{t-k}."""
    theta, y_lags, u_lags = equation
    total = 0.0
    a[:] = 0.0
    b[:] = 0.0
    for j in range(theta.size):
        outputs = _times_factors(theta[j], y_lags[j], y, t, NONE)
        total += _times_factors(outputs, u_lags[j], u, t, NONE)
        for factor in range(y_lags.shape[1]):
            lag = y_lags[j, factor]
            if lag == NONE:
                break
            others = _times_factors(theta[j], y_lags[j], y, t, factor)
            a[lag] += _times_factors(others, u_lags[j], u, t, NONE)
        for factor in range(u_lags.shape[1]):
            lag = u_lags[j, factor]
            if lag == NONE:
                break
            b[lag] += _times_factors(outputs, u_lags[j], u, t, factor)
    return total


@njit(cache=True, error_model="numpy")
def _times_factors(value: float, lags: Indices, signal: Array, t: int, left_out: int) -> float:
    """Return ``value`` times the lagged factors of a signal in a term, without one of them."""
    for factor in range(lags.size):
        if lags[factor] == NONE:
            break
        if factor != left_out:
            value *= signal[t - lags[factor]]
    return value


@njit(cache=True, error_model="numpy")
def improve(
    equation: Equation, y: Array, u: Array, reference: Array, smoothness: float, limits: InputLimits
) -> bool:
    """Improve a plan by one Gauss-Newton step, in place, then bring it within limits and rate.

    Parameters
    ----------
    equation
        Of the model, whose units all signals are in.
    y, u
        The past and then the plan, (past + n,), with a past as long as the largest lag, two samples
        at least. Inputs of the plan are improved, and outputs written: those of the inputs as they
        were, the first of them that of its input as it is then.
    reference
        Outputs wanted, (n,).
    smoothness
        Weight of the squared second differences of the inputs.
    limits
        Of the inputs.

    Returns
    -------
    bool
        Whether the run stayed bounded; otherwise the inputs are as they were.
    """
    n = reference.size
    past = u.size - n
    a, b = np.empty(past + 1), np.empty(past + 1)
    S = np.zeros((n, n))  # of y_i by u_j
    error = np.empty(n)
    bound = DIVERGED * max(1.0, np.abs(reference).max())
    for i in range(n):
        y[past + i] = output_and_slopes(equation, y, u, past + i, a, b)
        if not abs(y[past + i]) < bound:
            return False
        error[i] = reference[i] - y[past + i]
        for k in range(min(past, i) + 1):
            S[i, i - k] += b[k]
        for k in range(1, min(past, i) + 1):
            for j in range(i - k + 1):
                S[i, j] += a[k] * S[i - k, j]
    normal, slope = S.T @ S, S.T @ error
    # Second differences u_j - 2 u_{j-1} + u_{j-2} of the plan, the first of which reach back.
    for j in range(n):
        curve = u[past + j] - 2.0 * u[past + j - 1] + u[past + j - 2]
        for d_1 in range(3):
            if j < d_1:
                continue
            w_1 = -2.0 if d_1 == 1 else 1.0
            slope[j - d_1] -= smoothness * w_1 * curve
            for d_2 in range(3):
                if j >= d_2:
                    w_2 = -2.0 if d_2 == 1 else 1.0
                    normal[j - d_1, j - d_2] += smoothness * w_1 * w_2
    step = np.linalg.solve(normal, slope)
    for i in range(n):
        u[past + i] = limited(u[past + i] + step[i], u[past + i - 1], limits)
    # The first output becomes the past of the next plan; where u(t) is in it, it has just changed.
    y[past] = output_and_slopes(equation, y, u, past, a, b)
    return True
