"""The compiled loops behind simulation and refinement.

A model is described by integer arrays: the group that each term belongs to (terms of a group have
the same output factors), the lags of each group's outputs and of each term's inputs, padded with
NONE. A run stops where an output exceeds the bound.
"""

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.narx.checks import Array

Indices: TypeAlias = NDArray[np.int64]

NONE = -1  # pads the lags of terms with fewer factors than the longest
BLOCK = 512  # samples whose products of inputs stay in the cache


@njit(cache=True, inline="always")
def output_of(coefficients: Array, i: int, y_lags: Indices, y: Array, t: int) -> float:
    """The output of sample t by (7), from its coefficients: sum_g C_g[i] * prod_k y_{t-k}."""
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
def _coefficients(
    group: Indices,
    u_lags: Indices,
    parameters: Array,
    u: Array,
    first: int,
    last: int,
    product: Array,
    coefficients: Array,
) -> None:
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
def run(
    group: Indices,
    y_lags: Indices,
    u_lags: Indices,
    parameters: Array,
    start: int,
    u: Array,
    y: Array,
    bound: float,
) -> None:
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
def run_varying(
    y_lags: Indices, u_lags: Indices, theta: Array, start: int, u: Array, y: Array, bound: float
) -> None:
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
def run_with_slope(
    group: Indices,
    y_lags: Indices,
    u_lags: Indices,
    theta: Array,
    start: int,
    u: Array,
    y: Array,
    slope: Array,
    bound: float,
) -> None:
    """Continue the run ``y`` and its derivatives ``slope`` by the parameters from ``start`` on."""
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
