"""Free runs fitted by parameters, starts and trends together, and how sure the parameters are."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dea import least_squares
from dea.arrays import Array, Segment
from dea.least_squares import Damping, Model, Point
from dea.narx import kernels
from dea.narx.estimation import too_little
from dea.narx.limits import bound_of
from dea.narx.parameter_covariance import (
    DEPENDENT,
    FreeRun,
    column_norms,
    covariance_of_free_runs,
    norms_of_squares,
)
from dea.narx.simulation import input_rows, simulate, structure
from dea.terms import Term

_ROUNDING = 1e-12  # share of the run's norm, up to which a departure is rounding
_ENDS = 2.0  # standard deviations either way, within which a run should be linear
DAMPING = Damping(least=1e-13, most=1e12)  # of the regressors' unit energy


class ReducedRuns(NamedTuple):
    """Free runs whose slope is what starts and trends leave of it.

    ``slope`` (samples, parameters) is that of all runs, and ``follow`` (starts and trends,
    parameters) how starts and trends follow where the parameters move.
    """

    runs: list[FreeRun]
    slope: Array
    follow: Array


@dataclass(frozen=True, eq=False)
class FreeRunFit:
    """Parameters at a minimum of the simulated error, and how sure they are.

    The latter is computed when it is asked for: a search compares many fits by their errors.

    Parameters
    ----------
    parameters : (terms,)
    msse
        Mean squared simulated error (6), normalised units.
    unknowns
        The parameters, and after them starts and trend of each segment.
    objective
        What was minimised, which refers to the segments.
    """

    parameters: Array
    msse: float
    unknowns: Array
    objective: "_FreeRunsFromFreeStarts"

    @cached_property
    def reduced(self) -> ReducedRuns:
        """The runs at the minimum; they do not diverge."""
        return self.objective.told_apart(self.unknowns)

    @cached_property
    def covariance(self) -> Array:
        """Covariance (terms, terms) of the parameters; NaN where the run diverges."""
        if not np.isfinite(self.msse):
            return np.full((self.parameters.size,) * 2, np.nan)
        return covariance_of_free_runs(
            self.objective.terms, self.parameters, self.reduced.runs, self.unknowns.size
        )

    @cached_property
    def withheld(self) -> str:
        """Why the covariance gives no intervals, empty where it does."""
        if not np.isfinite(self.msse):
            return ""
        seen = self.reduced.slope
        singular = np.linalg.svd(seen / column_norms(seen), compute_uv=False)
        undetermined = int(np.sum(singular**2 <= DEPENDENT * singular[0] ** 2))
        return too_little(len(seen), self.unknowns.size, undetermined)


def fit_free_runs(
    terms: tuple[Term, ...],
    start: Array,
    segments: Sequence[Segment],
    iterations: int = 30,
    tolerance: float = 1e-10,
    trend: int = 0,
) -> FreeRunFit:
    """Minimise the simulated error by the parameters and the outputs that each run starts from.

    With a ``trend``, each measured output is the run plus a polynomial of time of that degree
    without a constant, also unknown: a level that creeps beside the dynamics.

    A start from which the run diverges comes back with an infinite error, and without covariance.
    """
    objective = _FreeRunsFromFreeStarts(terms, segments, trend)
    point = least_squares.minimise(
        objective, objective.initial(start), DAMPING, iterations=iterations, tolerance=tolerance
    )
    theta = point.x[: len(terms)].copy()
    return FreeRunFit(theta, point.cost / objective.samples, point.x, objective)


def curvature(fit: FreeRunFit) -> float:
    """Return how far the free run is from linear within two standard deviations of an estimate.

    Along each direction that the output tells apart, the run at either end is set against its
    linearisation, on which the covariance rests; starts and trend follow as the latter says. The
    departure, as a share of what the linearisation predicts, is the largest over all directions: D.
    M. Bates and D. G. Watts, JRSS B 42 (1980), relative curvatures. Infinite where a run diverges
    or rounding has left a direction without a variance.
    """
    if not np.isfinite(fit.msse):
        return np.inf
    objective, seen = fit.objective, fit.reduced.slope
    norms = column_norms(seen)
    covariance = fit.covariance * np.outer(norms, norms)
    middle, largest = objective.outputs(fit.unknowns), 0.0
    rounding = _ROUNDING * float(np.linalg.norm(middle))
    _, size, directions = np.linalg.svd(seen / norms, full_matrices=False)
    for energy, direction in zip(size**2, directions, strict=True):
        variance = float(direction @ covariance @ direction)
        if not variance > 0.0 or energy <= DEPENDENT * size[0] ** 2:
            return np.inf
        moved = _ENDS * np.sqrt(variance) * direction / norms
        step = np.concatenate([moved, -fit.reduced.follow @ moved])
        linear = seen @ moved
        for sign in (1.0, -1.0):
            apart = objective.outputs(fit.unknowns + sign * step) - middle - sign * linear
            if not np.isfinite(apart).all():
                return np.inf
            departure = max(float(np.linalg.norm(apart)) - rounding, 0.0)
            largest = max(largest, departure / float(np.linalg.norm(linear)))
    return largest


class _FreeRunsFromFreeStarts:
    """Free runs whose starts and trends are among the unknowns, after theta."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment], trend: int) -> None:
        self.terms, self._segments = terms, segments
        self._lag = structure(terms).start
        self._trends = [_powers(y.size, trend) for _, y in segments]
        self._own = self._lag + trend  # unknowns of each segment
        self._bound = bound_of(segments)
        self.samples = sum(y.size for _, y in segments)

    def initial(self, theta: Array) -> Array:
        """Return ``theta``, and of every segment the measured first outputs and no trend."""
        none = np.zeros(self._own - self._lag)
        return np.concatenate([theta, *((*y[: self._lag], *none) for _, y in self._segments)])

    def evaluate(self, x: Array) -> Point[None]:
        theta, starts = self._split(x)
        total = 0.0
        for (u, y), powers, own in zip(self._segments, self._trends, starts, strict=True):
            run = simulate(self.terms, theta, u, own[: self._lag], bound=self._bound)
            if not np.isfinite(run[-1]):
                return Point(x, np.inf, None)
            total += float(np.sum((y - run - powers @ own[self._lag :]) ** 2))
        return Point(x, total, None)

    def linearise(self, point: Point[None], iteration: int, exact: bool) -> Model | None:
        runs = [(run.residual, run.slope, own) for run, own in self.runs(point.x)]
        return damped(float(sum(residual @ residual for residual, _, _ in runs)), runs)

    def outputs(self, x: Array) -> Array:
        """Return the runs of all segments with their trends; infinite where one diverges."""
        theta, starts = self._split(x)
        parts = [
            simulate(self.terms, theta, u, own[: self._lag], bound=self._bound)
            + powers @ own[self._lag :]
            for (u, y), powers, own in zip(self._segments, self._trends, starts, strict=True)
        ]
        return np.concatenate(parts)

    def runs(self, x: Array) -> list[tuple[FreeRun, Array]]:
        """Return the free run of every segment, and its slope by its own start and trend."""
        theta, starts = self._split(x)
        count, runs = theta.size, []
        for (u, y), powers, unknown in zip(self._segments, self._trends, starts, strict=True):
            output = np.empty(y.size)
            output[: self._lag] = unknown[: self._lag]
            slope = np.zeros((y.size, count + self._lag))
            slope[: self._lag, count:] = np.eye(self._lag)
            rows = input_rows(self.terms, u)
            kernels.run_with_slope(structure(self.terms), theta, rows, output, slope, self._bound)
            left = y - output - powers @ unknown[self._lag :]
            own = np.hstack([slope[:, count:], powers])
            runs.append((FreeRun(u, output, left, slope[:, :count]), own))
        return runs

    def told_apart(self, x: Array) -> ReducedRuns:
        """Return the runs with the part of their slope that starts and trends leave.

        It is what the regression on their columns leaves, which are zero outside of their own
        segment.
        """
        told, follow = [], []
        for run, own in self.runs(x):
            by_own = np.linalg.lstsq(own, run.slope, rcond=None)[0]
            told.append(run._replace(slope=run.slope - own @ by_own))
            follow.append(by_own)
        return ReducedRuns(told, np.vstack([run.slope for run in told]), np.vstack(follow))

    def _split(self, x: Array) -> tuple[Array, Array]:
        count = len(self.terms)
        return x[:count], x[count:].reshape(len(self._segments), self._own)


def _powers(samples: int, degree: int) -> Array:
    """Return the powers of time from the first on, (samples, degree); time from -1 to 1."""
    time = np.linspace(-1.0, 1.0, samples)
    return time[:, None] ** np.arange(1, degree + 1)


def damped(error: float, runs: Sequence[tuple[Array, Array, Array]]) -> Model:
    """Return the linearised problem, whose steps are damped in units of each column's norm.

    Of each run there are the residual, its slope by the parameters and by unknowns of its own.
    These meet those of no other run in the normal equations: they are eliminated run by run, so
    that many short runs cost no more than one that is as long.
    """
    count, own = (slope.shape[1] for slope in runs[0][1:])
    squares, descent = np.zeros((count, count)), np.zeros(count)
    both = np.empty((len(runs), own, count))
    blocks, falls = np.empty((len(runs), own, own)), np.empty((len(runs), own, 1))
    for i, (residual, slope, of_own) in enumerate(runs):
        squares += slope.T @ slope
        descent += slope.T @ residual
        both[i], blocks[i] = of_own.T @ slope, of_own.T @ of_own
        falls[i, :, 0] = of_own.T @ residual
    norms = norms_of_squares(np.diag(squares))
    own_norms = norms_of_squares(np.einsum("kii->ki", blocks))[:, :, None]
    squares, descent = squares / np.outer(norms, norms), descent / norms
    both, falls = both / own_norms / norms, falls / own_norms
    blocks = blocks / own_norms / own_norms.transpose(0, 2, 1)

    def step(damping: float) -> Array:
        solved = np.linalg.solve(
            blocks + damping * np.eye(own), np.concatenate([both, falls], axis=2)
        )
        by_parameters, by_falls = solved[:, :, :count], solved[:, :, count:]
        left = squares - np.einsum("koi,koj->ij", both, by_parameters)
        energy, directions = np.linalg.eigh(left)
        energy = np.maximum(energy, 0.0)  # rounding may make a zero eigenvalue negative
        towards = descent - np.einsum("koi,ko->i", both, by_falls[:, :, 0])
        moved = directions @ (directions.T @ towards / (energy + damping))
        followed = by_falls[:, :, 0] - by_parameters @ moved
        return np.concatenate([moved / norms, (followed / own_norms[:, :, 0]).ravel()])

    return Model(error, step)
