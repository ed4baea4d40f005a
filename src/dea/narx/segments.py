"""Free runs through the segments of a record, with their exact sensitivities."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Segment
from dea.narx import kernels
from dea.narx.limits import bound_of
from dea.narx.simulation import BOUND, input_rows, structure
from dea.terms import Term


def sensitivities(
    terms: tuple[Term, ...], theta: Array, u: Array, y_initial: Array, bound: float = BOUND
) -> tuple[Array, Array]:
    """Simulate freely together with the derivative of the run by each parameter.

    Differentiating (7): dy_t/dtheta_j = phi_j(x_t) + sum_k (df/dy_{t-k}) dy_{t-k}/dtheta_j.

    Returns
    -------
    y, slope
        Outputs, shape (samples,), and derivatives, shape (samples, terms). Both are ``inf`` from
        the sample on where the run diverges.
    """
    shape = structure(terms)
    y = np.empty(u.shape[0])
    y[: shape.start] = y_initial[: shape.start]
    slope = np.zeros((y.size, len(terms)))
    kernels.run_with_slope(shape, theta, input_rows(terms, u), y, slope, bound)
    return y, slope


class LinearisedRuns(NamedTuple):
    """The free runs at one point of the parameter space and their slope there."""

    error: float  # sum of squares; inf where a run diverges
    residual: Array  # (samples,) measured less simulated, all segments
    slope: Array  # (samples, terms) derivative of the run by each parameter


def linearise(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> LinearisedRuns:
    """Simulate every segment with its sensitivities."""
    return Segments(terms, segments).linearise(theta)


def squared_error(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> float:
    """Sum of squared errors of the free runs; infinite where one diverges."""
    return Segments(terms, segments).squared_error(theta)


class Segments:
    """Segments end to end, as one call of a kernel runs through them; each from its own outputs."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment]) -> None:
        self._shape = structure(terms)
        self._u = np.concatenate([input_rows(terms, u).ravel() for u, _ in segments])
        self._y = np.concatenate([y for _, y in segments])
        self._ends = np.cumsum([y.size for _, y in segments], dtype=np.int64)
        self._bounds = np.full(len(segments), bound_of(segments))
        begins = (0, *self._ends[:-1].tolist())
        # Outputs before the start are given, not simulated.
        self.scored = [
            slice(min(begin + self._shape.start, end), end)
            for begin, end in zip(begins, self._ends.tolist(), strict=True)
        ]

    def squared_error(self, theta: Array) -> float:
        """Sum of squared errors; infinite where a run diverges."""
        run = self._y.copy()
        if not kernels.run_each(self._shape, theta, self._u, run, self._ends, self._bounds):
            return np.inf
        return sum(float(np.sum((self._y[part] - run[part]) ** 2)) for part in self.scored)

    def linearise(self, theta: Array) -> LinearisedRuns:
        """Free runs and their derivatives by the parameters."""
        run, slope = self._y.copy(), np.zeros((self._y.size, theta.size))
        if not kernels.run_each_with_slope(
            self._shape, theta, self._u, run, slope, self._ends, self._bounds
        ):
            return LinearisedRuns(np.inf, np.empty(0), np.empty((0, theta.size)))
        residual = np.concatenate([self._y[part] - run[part] for part in self.scored])
        if len(self.scored) == 1:
            slope = slope[self.scored[0]]
        else:
            slope = np.concatenate([slope[part] for part in self.scored])
        return LinearisedRuns(float(residual @ residual), residual, slope)
