"""The compiled loops behind simulation and refinement.

A run stops where an output exceeds the bound.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.arrays import Array, Indices

NONE = -1  # pads the lags of terms with fewer factors than the longest
BLOCK = 512  # samples whose products of inputs stay in the cache


class Structure(NamedTuple):
    """The terms of a model as integer arrays; terms of a group have the same output factors."""

    group: Indices  # (terms,) which group each term belongs to
    y_lags: Indices  # (groups, most factors), padded with NONE
    u_lags: Indices  # (terms, most factors), padded with NONE
    u_rows: Indices  # (terms, most factors) the row of the input that each factor is of
    start: int  # the first sample that can be computed


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
    structure: Structure, parameters: Array, u: Array, first: int, last: int, work: Array
) -> None:
    """Write C_g[t] of the samples from ``first`` to before ``last`` into the rows of ``work``.

    Its last row, one more than there are groups, holds one term's product of inputs meanwhile.
    """
    group, u_lags, u_rows = structure.group, structure.u_lags, structure.u_rows
    count = last - first
    work[:, :count] = 0.0
    product = work[-1]
    for j in range(group.size):
        product[:count] = parameters[j]
        for factor in range(u_lags.shape[1]):
            lag = u_lags[j, factor]
            if lag == NONE:
                break
            shifted = u[u_rows[j, factor], first - lag : last - lag]
            for i in range(count):
                product[i] *= shifted[i]
        row = work[group[j]]
        for i in range(count):
            row[i] += product[i]


@njit(cache=True)
def run(structure: Structure, parameters: Array, u: Array, y: Array, bound: float) -> None:
    """Continue ``y`` from the structure's start, infinite from the sample on where it diverges.

    Each row of ``u`` is one input, shape (inputs, samples).
    """
    y_lags = structure.y_lags
    work = np.empty((y_lags.shape[0] + 1, BLOCK))
    for first in range(structure.start, y.size, BLOCK):
        last = min(first + BLOCK, y.size)
        _coefficients(structure, parameters, u, first, last, work)
        for t in range(first, last):
            total = output_of(work, t - first, y_lags, y, t)
            if not abs(total) <= bound:
                y[t:] = np.inf
                return
            y[t] = total


@njit(cache=True)
def bounded(
    structure: Structure,
    parameters: Array,
    u: Array,
    samples: int,
    first: float,
    bound: float,
    every: bool,
) -> NDArray[np.bool_]:
    """Whether each of several runs keeps within the bound about its first output, shape (runs,).

    ``u`` has the shape (inputs, period, runs) and is repeated over all ``samples``. Where ``every``
    run has to keep within the bound, the first that does not ends all. The runs go on side by side,
    since each sample of a run waits for the one before; a run that has left the bound goes on from
    its first output and does not count as kept.
    """
    group, y_lags, u_lags, u_rows, start = structure
    _, period, runs = u.shape
    kept = np.ones(runs, dtype=np.bool_)
    depth = start + 1
    past = np.full((depth, runs), first)
    coefficients = np.empty((y_lags.shape[0], runs))
    product, total = np.empty(runs), np.empty(runs)
    for t in range(start, samples):
        coefficients[:] = 0.0
        for j in range(group.size):
            row = coefficients[group[j]]
            product[:] = parameters[j]
            for factor in range(u_lags.shape[1]):
                if u_lags[j, factor] == NONE:
                    break
                values = u[u_rows[j, factor], (t - u_lags[j, factor]) % period]
                for i in range(runs):
                    product[i] *= values[i]
            for i in range(runs):
                row[i] += product[i]
        total[:] = 0.0
        for g in range(y_lags.shape[0]):
            row = coefficients[g]
            for factor in range(y_lags.shape[1]):
                if y_lags[g, factor] == NONE:
                    break
                values = past[(t - y_lags[g, factor]) % depth]
                for i in range(runs):
                    row[i] *= values[i]
            for i in range(runs):
                total[i] += row[i]
        inside = True
        for i in range(runs):
            inside &= abs(total[i] - first) <= bound
        if not inside:
            if every:
                return np.zeros(runs, dtype=np.bool_)
            for i in range(runs):
                if not abs(total[i] - first) <= bound:
                    kept[i], total[i] = False, first
        row = past[t % depth]
        for i in range(runs):
            row[i] = total[i]
    return kept


@njit(cache=True)
def run_varying(structure: Structure, theta: Array, u: Array, y: Array, bound: float) -> None:
    """As :func:`run` with ``theta[t]`` at sample t."""
    y_lags, u_lags, u_rows = structure.y_lags[structure.group], structure.u_lags, structure.u_rows
    flat, places = u.ravel(), u_rows * u.shape[1] - u_lags  # of each factor at sample 0
    powers = np.zeros(u_lags.shape[0], dtype=np.int64)
    for j in range(u_lags.shape[0]):  # a sum along an axis takes seconds to compile
        powers[j] = np.count_nonzero(u_lags[j] != NONE)
    for t in range(structure.start, y.size):
        total = 0.0
        for j in range(y_lags.shape[0]):
            monomial = theta[t, j]
            for factor in range(y_lags.shape[1]):
                if y_lags[j, factor] == NONE:
                    break
                monomial *= y[t - y_lags[j, factor]]
            for factor in range(powers[j]):
                monomial *= flat[places[j, factor] + t]
            total += monomial
        if not abs(total) <= bound:
            y[t:] = np.inf
            return
        y[t] = total


@njit(cache=True)
def run_with_slope(
    structure: Structure, theta: Array, u: Array, y: Array, slope: Array, bound: float
) -> None:
    """As :func:`run`, and continue the derivatives ``slope`` of ``y``.

    Its first columns are those of the parameters; further ones are of quantities that act only
    through the samples before the structure's start, such as the initial outputs themselves.
    """
    group, y_lags, u_lags, u_rows, start = structure
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
                source = u[u_rows[j, factor]]
                for i in range(last - first):
                    inputs[i, j] *= source[first + i - lag]
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
            slope[t, terms:] = 0.0
            for k in range(1, start + 1):
                if feedback[k] != 0.0:
                    for j in range(slope.shape[1]):
                        slope[t, j] += feedback[k] * slope[t - k, j]


@njit(cache=True)
def run_each(
    structure: Structure, parameters: Array, u: Array, y: Array, ends: Indices, bounds: Array
) -> bool:
    """As :func:`run` over segments end to end; false at the first that diverges.

    ``u``, shape (inputs x samples,), holds of one segment after the other its inputs, each in turn;
    ``ends`` are those of the segments in ``y``, and each has its bound.
    """
    inputs, begin = u.size // y.size, 0
    for number in range(ends.size):
        end = ends[number]
        rows = u[inputs * begin : inputs * end].reshape(inputs, end - begin)
        run(structure, parameters, rows, y[begin:end], bounds[number])
        if not np.isfinite(y[end - 1]):
            return False
        begin = end
    return True


@njit(cache=True)
def run_each_with_slope(
    structure: Structure, theta: Array, u: Array, y: Array, slope: Array, ends: Indices,
    bounds: Array,
) -> bool:  # fmt: skip
    """As :func:`run_with_slope` over segments end to end; false at the first that diverges."""
    inputs, begin = u.size // y.size, 0
    for number in range(ends.size):
        end = ends[number]
        rows = u[inputs * begin : inputs * end].reshape(inputs, end - begin)
        run_with_slope(structure, theta, rows, y[begin:end], slope[begin:end], bounds[number])
        if not np.isfinite(y[end - 1]):
            return False
        begin = end
    return True
