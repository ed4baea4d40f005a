"""The compiled loops behind simulation, trials and refinement.

They live in one file so that an edit to one that another calls recompiles both. A model comes as
integer arrays: which group each term belongs to (terms of a group share their outputs), the lags of
each group's outputs and of each term's inputs, padded with NONE. Runs stop where an output exceeds
the bound.
"""

import numpy as np
from numba import njit

NONE = -1  # pads the lags of monomials with fewer factors than the longest
_BLOCK = 512  # samples whose products of inputs stay in the cache
_DEPENDENT = 1e-12  # of a regressor's norm: less than this is rounding


@njit(cache=True, inline="always")
def _output(coefficients, i, y_lags, y, t):
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
    coefficients = np.empty((y_lags.shape[0], _BLOCK))
    product = np.empty(_BLOCK)
    for first in range(start, y.size, _BLOCK):
        last = min(first + _BLOCK, y.size)
        _coefficients(group, u_lags, parameters, u, first, last, product, coefficients)
        for t in range(first, last):
            total = _output(coefficients, t - first, y_lags, y, t)
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
    inputs = np.empty((_BLOCK, terms))  # each term's product of inputs
    outputs = np.empty(groups)  # each group's product of outputs
    coefficients = np.empty(groups)
    feedback = np.empty(start + 1)  # df/dy_{t-k}
    for first in range(start, y.size, _BLOCK):
        last = min(first + _BLOCK, y.size)
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


@njit(cache=True)
def solve_subset(triangle, columns, count):
    """Least squares (4) by modified Gram-Schmidt on the compressed regressors.

    ``triangle`` holds a regressor a row, the output last. A regressor that depends on those before
    it gets the parameter zero.
    """
    rows = triangle.shape[1]
    q = np.empty((count, rows))
    upper = np.zeros((count, count))
    projection = np.zeros(count)
    rest = triangle[-1].copy()
    for i in range(count):
        column = q[i]
        column[:] = triangle[columns[i]]
        norm = np.sqrt(np.dot(column, column))
        for m in range(i):
            if upper[m, m] > 0.0:
                upper[m, i] = np.dot(q[m], column)
                for row in range(rows):
                    column[row] -= upper[m, i] * q[m, row]
        left = np.sqrt(np.dot(column, column))
        if left > _DEPENDENT * norm:
            upper[i, i] = left
            for row in range(rows):
                column[row] /= left
            projection[i] = np.dot(column, rest)
            for row in range(rows):
                rest[row] -= projection[i] * column[row]
    theta = np.zeros(count)
    for i in range(count - 1, -1, -1):
        if upper[i, i] > 0.0:
            total = projection[i]
            for m in range(i + 1, count):
                total -= upper[i, m] * theta[m]
            theta[i] = total / upper[i, i]
    return theta


@njit(cache=True)
def run_trials(
    columns, triangle, group, y_lags, product, products, y, ends, start, bound, error, theta
):
    """Estimate and simulate each row of ``columns``; fill its sum of squared errors and theta."""
    longest = 0
    begin = 0
    for end in ends:
        longest = max(longest, end - begin)
        begin = end
    run = np.empty(longest)
    place = np.empty(y_lags.shape[0], dtype=np.int64)
    used = np.empty(y_lags.shape[0], dtype=np.int64)
    for trial in range(columns.shape[0]):
        count = 0
        while count < columns.shape[1] and columns[trial, count] != NONE:
            count += 1
        solution = solve_subset(triangle, columns[trial], count)
        theta[trial, :count] = solution
        place[:] = NONE
        groups = 0
        for j in range(count):
            g = group[columns[trial, j]]
            if place[g] == NONE:
                place[g] = groups
                used[groups] = g
                groups += 1
        monomials = y_lags[used[:groups]]
        total = 0.0
        begin = 0
        for end in ends:
            run[:start] = y[begin : begin + start]
            total += _squared_error(
                columns[trial, :count],
                solution,
                group,
                place,
                monomials,
                product,
                products[:, begin:end],
                y[begin:end],
                run,
                start,
                bound,
            )
            begin = end
        error[trial] = total


@njit(cache=True)
def _squared_error(
    columns, theta, group, place, monomials, product, products, y, run, start, bound
):
    """Sum of squared errors of one free run, infinite where it leaves the bound."""
    coefficients = np.empty((monomials.shape[0], _BLOCK))
    total = 0.0
    for first in range(start, y.size, _BLOCK):
        last = min(first + _BLOCK, y.size)
        coefficients[:] = 0.0
        for j in range(columns.size):
            row = coefficients[place[group[columns[j]]]]
            values = products[product[columns[j]], first:last]
            parameter = theta[j]
            for i in range(last - first):
                row[i] += parameter * values[i]
        for t in range(first, last):
            output = _output(coefficients, t - first, monomials, run, t)
            if not abs(output) <= bound:
                return np.inf
            run[t] = output
            total += (output - y[t]) ** 2
    return total
