"""SINDy on the discrepancy: a sparse equation of the residual's dynamics, and the name in it.

The residual e, its rate or its acceleration is regressed on a library of terms, and on e and its
lower derivatives, by sequentially thresholded least squares. All go through the same Savitzky–Golay
filter. There is an equation for every choice of the derivative, the filter's length, the threshold
and the ridge. Of those that, run freely, predict the last quarter of the seen part nearly as well
as the best, the one with the fewest terms is taken and fitted again to all that is seen. Equations
that do not return to zero without forcing are left out.
"""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.signal import savgol_filter

from benchmarks.naming.methods._library import CORRECTION, FOREIGN, Term, library
from benchmarks.naming.methods._residual import Mask, Residual, needed
from benchmarks.naming.methods._stlsq import stlsq
from benchmarks.naming.task import Answer, Method, Task
from dea.arrays import Array

_ORDERS = (0, 1, 2)  # of the derivative
_LENGTHS = (5, 11, 25, 51, 101)  # samples of the filter
_THRESHOLDS = np.geomspace(0.01, 0.5, 10)  # of the derivative's root mean square
_RIDGES = (1e-5, 1e-3, 0.1)  # of the number of samples
_NEARLY = 1.5  # times the least error, up to which an equation of fewer terms is preferred
_SECOND = 0.5  # part of the leading effect's contribution from which a second one is named


@dataclass(frozen=True)
class Equation:
    """The derivative of an ``order`` is ``own`` times e, e' and so on, and ``forcing`` terms.

    ``G`` holds the mean products of all columns of the regression, in units of their root mean
    squares: of e and its derivatives, of the terms, and of the derivative, which is the last.
    """

    order: int
    own: Array
    forcing: Array
    G: Array

    @property
    def stable(self) -> bool:
        """Whether e returns to zero without forcing."""
        return bool((self.own < 0.0).all())

    @property
    def size(self) -> int:
        """Number of terms."""
        return int(np.count_nonzero(self.own) + np.count_nonzero(self.forcing))


class Setting(NamedTuple):
    """How an equation is found."""

    order: int
    length: int
    threshold: float
    ridge: float


@dataclass(frozen=True)
class Discrepancy:
    """The residual, and the terms that it is regressed on."""

    residual: Residual
    terms: list[Term]
    interval: float

    @classmethod
    def of(cls, task: Task) -> "Discrepancy":
        """Return that of a task."""
        residual = Residual.of(task)
        terms = library(task.u, residual.held, residual.values, task.interval)
        return cls(residual, terms, task.interval)

    def equations(self, samples: Mask) -> dict[Setting, Equation]:
        """Return the sparse equation of every setting from ``samples`` (m,)."""
        found = {}
        e = self.residual.values
        terms = np.column_stack([term.values[: e.size] for term in self.terms])
        for length in _LENGTHS:
            smooth = savgol_filter(terms, length, 3, axis=0)[samples]
            states = [
                savgol_filter(e, length, 3, deriv=n, delta=self.interval)[samples]
                for n in range(max(_ORDERS) + 1)
            ]
            for order in _ORDERS:
                X = np.column_stack([*states[:order], smooth, states[order]])
                scale = np.sqrt(np.mean(X**2, axis=0)) + 1e-300
                G = (X / scale).T @ (X / scale) / len(X)
                for threshold, ridge in product(_THRESHOLDS, _RIDGES):
                    sparse = stlsq(G[:-1, :-1], G[:-1, -1], threshold, ridge)
                    sparse = sparse * scale[-1] / scale[:-1]
                    equation = Equation(order, sparse[:order], sparse[order:], G)
                    found[Setting(order, length, threshold, ridge)] = equation
        return found

    def run(self, equation: Equation) -> Array:
        """Return the free run of an equation over the whole record, (n,)."""
        forcing = np.column_stack([term.values for term in self.terms]) @ equation.forcing
        if equation.order == 0:
            return forcing
        first = int(np.argmax(self.residual.used))
        start = np.zeros(equation.order)
        start[0] = np.mean(self.residual.values[first : first + 5])
        return run(equation.own, forcing, start, first, self.interval)

    def signs(self, order: int) -> list[str]:
        """Return what each term is a sign of in an equation of an order."""
        return [term.in_motion if order else term.in_reading for term in self.terms]

    def names(self, equation: Equation) -> frozenset[str]:
        """Return the effects that the terms of an equation are signs of.

        An effect contributes what the regression leaves more, as a root mean square, if its terms
        are dropped and the others fitted again. The one that contributes most is named, and the
        second, where it contributes half as much. Terms that correct parameters of the simulation
        do not count; where terms that are signs of no effect lead, there is no name.
        """
        kept = np.concatenate([equation.own, equation.forcing]) != 0.0
        signs = np.array([*[CORRECTION] * equation.order, *self.signs(equation.order)])
        before = _left(equation.G, kept)
        sizes = {
            name: np.sqrt(max(_left(equation.G, kept & (signs != name)) - before, 0.0))
            for name in {*signs[kept]} - {CORRECTION}
        }
        leading = sorted(sizes, key=lambda name: (-sizes[name], name))[:2]
        if not leading or leading[0] == FOREIGN:
            return frozenset()
        enough = _SECOND * sizes[leading[0]]
        return frozenset(str(n) for n in leading if n != FOREIGN and sizes[n] >= enough)


def _left(G: Array, kept: Mask) -> float:
    """Return the mean square that the last column of ``G`` has beside the columns ``kept``."""
    own, b = G[:-1, :-1][np.ix_(kept, kept)], G[:-1, -1][kept]
    return float(G[-1, -1] - b @ np.linalg.lstsq(own, b, rcond=None)[0])


def answer(task: Task) -> Answer:
    """Name what leads in the equation, if that predicts the residual."""
    found = Discrepancy.of(task)
    residual = found.residual
    tried = []
    wholes = found.equations(residual.used)
    for setting, part in found.equations(residual.train).items():
        if part.stable and wholes[setting].stable:
            tried.append((part.size, residual.error(found.run(part)), setting))
    useful = [each for each in tried if needed(each[1], residual)]
    if not useful:
        return Answer("none", task.ahead(task.nominal))
    enough = _NEARLY * min(error for _, error, _ in useful)
    *_, chosen = min(each for each in useful if each[1] <= enough)
    equation = wholes[chosen]
    ahead = (residual.simulated + found.run(equation))[task.y.size :]
    names = found.names(equation)
    return Answer("named" if names else "unknown", ahead, names)


@njit(cache=True, error_model="numpy")
def run(own: Array, forcing: Array, start: Array, first: int, interval: float) -> Array:
    """Integrate the derivative of order len(own), ``own`` x + ``forcing``, by the trapezoidal rule.

    ``start`` holds e and its lower derivatives at the sample ``first``; before it e is zero.
    """
    order = own.size
    A = np.zeros((order, order))
    for k in range(order - 1):
        A[k, k + 1] = 1.0
    A[order - 1] = own
    half = 0.5 * interval
    backward = np.linalg.inv(np.eye(order) - half * A)
    step, push = backward @ (np.eye(order) + half * A), half * backward[:, order - 1]
    result = np.zeros(forcing.size)
    x = start.copy()
    for k in range(first, forcing.size - 1):
        result[k] = x[0]
        x = step @ x + push * (forcing[k] + forcing[k + 1])
    result[forcing.size - 1] = x[0]
    return result


METHOD = Method(
    "SINDy on the discrepancy",
    "Brunton, Proctor and Kutz, PNAS 113 (2016) 3932; Kaheman et al., arXiv 1909.08574 (2019)",
    answer,
)
