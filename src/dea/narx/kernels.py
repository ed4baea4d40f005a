"""The compiled loops behind simulation and refinement.

A model comes as integer arrays: which group each term belongs to (terms of a group share their
outputs), the lags of each group's outputs and of each term's inputs, padded with NONE. Runs stop
where an output exceeds the bound.
"""

import numpy as np
from numba import njit

NONE = -1  # pads the lags of monomials with fewer factors than the longest
BLOCK = 512  # samples whose products of inputs stay in the cache


@njit(cache=True, inline="always")
def output_of(coefficients, i, y_lags, y, t):
    """What remains of (7) for sample t: sum_g C_g[i] * prod_k y_{t-k}."""
    total = 0.0
    for g in range(y_lags.shape[0]):
        monomial = coefficients[g, i]
        for factor in range(y_lags.shape[1]):
            lag = y_lags[g, factor]
            if lag == NONE:
                break
            monomial *= y[t - lag]
        total += monomial
    return total


@njit(cache=True)
def _coefficients(group, u_lags, parameters, u, first, last, product, coefficients):
    """Fill C_g[t] of the samples from ``first`` to before ``last``; ``product`` is scratch."""
    count = last - first
    coefficients[:, :count] = 0.0
    for j in range(group.size):
        product[:count] = parameters[j]
        for factor in range(u_lags.shape[1]):
            lag = u_lags[j, factor]
            if lag == NONE:
                break
            shifted = u[first - lag : last - lag]
            for i in range(count):
                product[i] *= shifted[i]
        row = coefficients[group[j]]
        for i in range(count):
            row[i] += product[i]


@njit(cache=True)
def run(group, y_lags, u_lags, parameters, start, u, y, bound):
    """Continue ``y`` from sample ``start``, infinite from the sample on where it diverges."""
    coefficients = np.empty((y_lags.shape[0], BLOCK))
    product = np.empty(BLOCK)
    for first in range(start, y.size, BLOCK):
        last = min(first + BLOCK, y.size)
        _coefficients(group, u_lags, parameters, u, first, last, product, coefficients)
        for t in range(first, last):
            total = output_of(coefficients, t - first, y_lags, y, t)
            if not abs(total) <= bound:
                y[t:] = np.inf
                return
            y[t] = total


@njit(cache=True)
def run_varying(y_lags, u_lags, theta, start, u, y, bound):
    """As :func:`run` with ``theta[t]`` at sample t; ``y_lags`` are those of each term."""
    for t in range(start, y.size):
        total = 0.0
        for j in range(y_lags.shape[0]):
            monomial = theta[t, j]
            for factor in range(y_lags.shape[1]):
                if y_lags[j, factor] == NONE:
                    break
                monomial *= y[t - y_lags[j, factor]]
            for factor in range(u_lags.shape[1]):
                if u_lags[j, factor] == NONE:
                    break
                monomial *= u[t - u_lags[j, factor]]
            total += monomial
        if not abs(total) <= bound:
            y[t:] = np.inf
            return
        y[t] = total


@njit(cache=True)
def run_with_slope(group, y_lags, u_lags, theta, start, u, y, slope, bound):
    """Continue run and slope from sample ``start``; terms that share their outputs share work."""
    groups, factors = y_lags.shape
    terms = theta.size
    inputs = np.empty((BLOCK, terms))  # each term's product of inputs
    outputs = np.empty(groups)  # each group's product of outputs
    coefficients = np.empty(groups)
    feedback = np.empty(start + 1)  # df/dy_{t-k}
    for first in range(start, y.size, BLOCK):
        last = min(first + BLOCK, y.size)
        inputs[:] = 1.0
        for j in range(terms):
            for factor in range(u_lags.shape[1]):
                lag = u_lags[j, factor]
                if lag == NONE:
                    break
                for i in range(last - first):
                    inputs[i, j] *= u[first + i - lag]
        for t in range(first, last):
            row = inputs[t - first]
            coefficients[:] = 0.0
            for j in range(terms):
                coefficients[group[j]] += theta[j] * row[j]
            feedback[:] = 0.0
            total = 0.0
            for g in range(groups):
                product = 1.0
                for factor in range(factors):
                    lag = y_lags[g, factor]
                    if lag == NONE:
                        break
                    product *= y[t - lag]
                    others = coefficients[g]
                    for other in range(factors):
                        if y_lags[g, other] == NONE:
                            break
                        if other != factor:
                            others *= y[t - y_lags[g, other]]
                    feedback[lag] += others
                outputs[g] = product
                total += coefficients[g] * product
            if not abs(total) <= bound:
                y[t:] = np.inf
                slope[t:] = np.inf
                return
            y[t] = total
            for j in range(terms):
                slope[t, j] = row[j] * outputs[group[j]]
            for k in range(1, start + 1):
                if feedback[k] != 0.0:
                    for j in range(terms):
                        slope[t, j] += feedback[k] * slope[t - k, j]
