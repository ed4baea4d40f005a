"""The compiled loops of a selection: estimate many subsets of the candidate terms, simulate each.

A model is described by integer arrays, as in :mod:`dea.narx.kernels`. A row of ``columns`` is a
candidate model: the indices of its terms, padded with NONE.
"""

import numpy as np
from numba import njit

from dea.narx.checks import Array
from dea.narx.kernels import BLOCK, NONE, Indices, output_of

_DEPENDENT = 1e-12  # share of a regressor's norm below which the rest is rounding


@njit(cache=True)
def solve_subset(triangle: Array, columns: Indices, count: int) -> Array:
    """Least squares (4) by modified Gram-Schmidt on the compressed regressors.

    Each row of ``triangle`` is a regressor, the last one the output. A regressor that depends
    linearly on those before it gets the parameter zero.
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
def estimate_and_simulate(
    columns: Indices,
    triangle: Array,
    group: Indices,
    y_lags: Indices,
    product: Indices,
    products: Array,
    y: Array,
    ends: Indices,
    start: int,
    bound: float,
    error: Array,
    theta: Array,
) -> None:
    """Estimate and simulate each row of ``columns``; fill its sum of squared errors and theta."""
    longest = 0
    begin = 0
    for end in ends:
        longest = max(longest, end - begin)
        begin = end
    run = np.empty(longest)
    place = np.empty(y_lags.shape[0], dtype=np.int64)
    used = np.empty(y_lags.shape[0], dtype=np.int64)
    for candidate in range(columns.shape[0]):
        count = 0
        while count < columns.shape[1] and columns[candidate, count] != NONE:
            count += 1
        solution = solve_subset(triangle, columns[candidate], count)
        theta[candidate, :count] = solution
        place[:] = NONE
        groups = 0
        for j in range(count):
            g = group[columns[candidate, j]]
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
                columns[candidate, :count],
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
        error[candidate] = total


@njit(cache=True)
def _squared_error(
    columns: Indices,
    theta: Array,
    group: Indices,
    place: Indices,
    monomials: Indices,
    product: Indices,
    products: Array,
    y: Array,
    run: Array,
    start: int,
    bound: float,
) -> float:
    """Sum of squared errors of one free run, infinite where it leaves the bound."""
    coefficients = np.empty((monomials.shape[0], BLOCK))
    total = 0.0
    for first in range(start, y.size, BLOCK):
        last = min(first + BLOCK, y.size)
        coefficients[:] = 0.0
        for j in range(columns.size):
            row = coefficients[place[group[columns[j]]]]
            values = products[product[columns[j]], first:last]
            parameter = theta[j]
            for i in range(last - first):
                row[i] += parameter * values[i]
        for t in range(first, last):
            output = output_of(coefficients, t - first, monomials, run, t)
            if not abs(output) <= bound:
                return np.inf
            run[t] = output
            total += (output - y[t]) ** 2
    return total
