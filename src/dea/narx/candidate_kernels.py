"""The compiled loops of a selection: estimate many subsets of the candidate terms, simulate each.

A row of ``columns`` is a candidate model: the indices of its terms, padded with NONE.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array, Indices
from dea.narx.kernels import BLOCK, NONE, output_of

_DEPENDENT = 1e-12  # share of a regressor's norm below which the rest is rounding


class Candidates(NamedTuple):
    """The candidate terms as integer arrays; terms of a group have the same output factors."""

    group: Indices  # (terms,) which group each term belongs to
    y_lags: Indices  # (groups, most factors), padded with NONE
    product: Indices  # (terms,) which row of ``EstimationData.products`` holds its input factors
    start: int  # the first sample of a segment that can be computed


class EstimationData(NamedTuple):
    """The segments that candidate models are estimated from and simulated on, end to end."""

    triangle: Array  # (terms + 1, rows) the regressors and the output, compressed by QR
    products: Array  # (products, samples) each product of inputs
    y: Array  # (samples,)
    ends: Indices  # (segments,) where each segment ends


class _Model(NamedTuple):
    """One candidate model, with the fields of :class:`Candidates` for its own terms."""

    parameters: Array
    group: Indices
    y_lags: Indices
    product: Indices


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
        for row in range(rows):  # a loop compiles in a tenth of the time of an array's assignment
            column[row] = triangle[columns[i], row]
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
    columns: Indices, candidates: Candidates, data: EstimationData, bound: float
) -> tuple[Array, Array]:
    """Estimate and simulate each row of ``columns``: its sum of squared errors and theta."""
    error, theta = np.empty(columns.shape[0]), np.zeros(columns.shape)
    longest = 0
    begin = 0
    for end in data.ends:
        longest = max(longest, end - begin)
        begin = end
    run = np.empty(longest)
    groups = candidates.y_lags.shape[0]
    place = np.empty(groups, dtype=np.int64)
    used = np.empty(groups, dtype=np.int64)
    for row in range(columns.shape[0]):
        count = 0
        while count < columns.shape[1] and columns[row, count] != NONE:
            count += 1
        terms = columns[row, :count]
        parameters = solve_subset(data.triangle, columns[row], count)
        for j in range(count):
            theta[row, j] = parameters[j]
        group, product = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
        place[:] = NONE
        groups = 0
        for j in range(count):
            g = candidates.group[terms[j]]
            if place[g] == NONE:
                place[g] = groups
                used[groups] = g
                groups += 1
            group[j] = place[g]
            product[j] = candidates.product[terms[j]]
        model = _Model(parameters, group, candidates.y_lags[used[:groups]], product)
        total = 0.0
        begin = 0
        for end in data.ends:
            y = data.y[begin:end]
            for t in range(candidates.start):
                run[t] = y[t]
            products = data.products[:, begin:end]
            total += _squared_error(model, products, y, run, candidates.start, bound)
            begin = end
        error[row] = total
    return error, theta


@njit(cache=True)
def _squared_error(
    model: _Model, products: Array, y: Array, run: Array, start: int, bound: float
) -> float:
    """Sum of squared errors of one free run, infinite where it leaves the bound."""
    coefficients = np.empty((model.y_lags.shape[0], BLOCK))
    total = 0.0
    for first in range(start, y.size, BLOCK):
        last = min(first + BLOCK, y.size)
        coefficients[:] = 0.0
        for j in range(model.parameters.size):
            row = coefficients[model.group[j]]
            values = products[model.product[j], first:last]
            parameter = model.parameters[j]
            for i in range(last - first):
                row[i] += parameter * values[i]
        for t in range(first, last):
            output = output_of(coefficients, t - first, model.y_lags, run, t)
            if not abs(output) <= bound:
                return np.inf
            run[t] = output
            total += (output - y[t]) ** 2
    return total
