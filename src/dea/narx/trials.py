"""Trial models: any subset of the candidate terms, estimated and simulated freely, fast.

The candidates' regressors are compressed once to a triangle by QR, so that least squares (4) on a
subset costs nothing that grows with the record and, unlike normal equations, does not square the
condition number: neighbouring lags of a smooth signal are almost collinear. Products of inputs
are computed once as well; only the recursion (7) is left for each trial.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from dea.narx.checks import Array
from dea.narx.regressors import regressor_matrix
from dea.narx.simulation import structure
from dea.narx.terms import Term, max_lag

Subset = tuple[int, ...]
Segment = tuple[Array, Array]

_DIVERGED = 100.0  # times the largest measured output
_DEPENDENT = 1e-12  # of a regressor's norm: less than this is rounding
_BLOCK = 512
_NONE = -1


class Outcome(NamedTuple):
    """What became of a trial model."""

    msse: float  # mean squared simulated error (6); inf where the run diverged
    parameters: Array  # (terms of the subset,)


class Trials:
    """Estimates and simulates models made of any of the candidate terms.

    Parameters
    ----------
    candidates
        All terms a model may have.
    segments
        Normalised inputs and outputs. Each is simulated from its own first outputs; they share
        their parameters.
    """

    def __init__(self, candidates: Sequence[Term], segments: Sequence[Segment]) -> None:
        self.candidates = tuple(candidates)
        self.start = max_lag(candidates)
        self._u = np.concatenate([u for u, _ in segments])
        self._y = np.concatenate([y for _, y in segments])
        ends = np.cumsum([u.size for u, _ in segments])
        self._ends = ends.astype(np.int64)
        self.samples = int(ends[-1] - self.start * len(segments))
        rows = [
            np.column_stack([regressor_matrix(candidates, u, y, self.start), y[self.start :]])
            for u, y in segments
        ]
        triangle: Array = np.linalg.qr(np.vstack(rows), mode="r")  # type: ignore[assignment]
        self._triangle = np.ascontiguousarray(triangle.T)
        self.power = float(np.mean(np.concatenate([row[:, -1] for row in rows]) ** 2))
        shape = structure(self.candidates)
        self._group, self._y_lags = shape.group, shape.y_lags
        monomials = sorted({term.u_lags for term in candidates})
        products = [Term((), lags) for lags in monomials]
        self._product = np.array(
            [monomials.index(term.u_lags) for term in candidates], dtype=np.int64
        )
        self._products = np.ones((len(monomials), self._u.size))
        first = max((term.max_lag for term in products), default=0)
        self._products[:, first:] = regressor_matrix(products, self._u, self._y, first).T
        self._bound = _DIVERGED * float(np.abs(self._y).max())
        self._known: dict[Subset, Outcome] = {}

    def __call__(self, subsets: Iterable[Subset]) -> list[Outcome]:
        """Return the outcome of each subset (sorted candidate indices); none is tried twice."""
        asked = list(subsets)
        fresh = [subset for subset in dict.fromkeys(asked) if subset not in self._known]
        if fresh:
            width = max(map(len, fresh))
            columns = np.full((len(fresh), width), _NONE, dtype=np.int64)
            for row, subset in zip(columns, fresh, strict=True):
                row[: len(subset)] = subset
            msse, theta = np.empty(len(fresh)), np.zeros((len(fresh), width))
            _run_trials(
                columns,
                self._triangle,
                self._group,
                self._y_lags,
                self._product,
                self._products,
                self._y,
                self._ends,
                self.start,
                self._bound,
                msse,
                theta,
            )
            for subset, error, parameters in zip(fresh, msse / self.samples, theta, strict=True):
                self._known[subset] = Outcome(float(error), parameters[: len(subset)])
        return [self._known[subset] for subset in asked]

    def estimate(self, subset: Subset) -> Array:
        """Return the least-squares parameters (4) of a subset without simulating it."""
        columns = np.array(subset, dtype=np.int64)
        return _solve(self._triangle, columns, len(subset))


@njit(cache=True)
def _solve(triangle, columns, count):
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
def _run_trials(
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
        while count < columns.shape[1] and columns[trial, count] != _NONE:
            count += 1
        solution = _solve(triangle, columns[trial], count)
        theta[trial, :count] = solution
        place[:] = _NONE
        groups = 0
        for j in range(count):
            g = group[columns[trial, j]]
            if place[g] == _NONE:
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
    groups, factors = monomials.shape
    coefficients = np.empty((groups, _BLOCK))
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
            output = 0.0
            for g in range(groups):
                monomial = coefficients[g, t - first]
                for factor in range(factors):
                    lag = monomials[g, factor]
                    if lag == _NONE:
                        break
                    monomial *= run[t - lag]
                output += monomial
            if not abs(output) <= bound:
                return np.inf
            run[t] = output
            total += (output - y[t]) ** 2
    return total
