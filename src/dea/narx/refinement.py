"""Parameters that minimise the simulated error: Levenberg-Marquardt on exact sensitivities."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dea import least_squares
from dea.errors import InputError
from dea.least_squares import Damping, Model, Point
from dea.narx import kernels
from dea.narx.checks import Array
from dea.narx.estimation import (
    Segment,
    Signals,
    as_segments,
    estimate,
    normalised,
    too_little,
)
from dea.narx.estimation import least_squares as least_squares_of
from dea.narx.labels import unpacked
from dea.narx.limits import DIVERGED
from dea.narx.model import NarxModel
from dea.narx.parameter_covariance import (
    DEPENDENT,
    FreeRun,
    column_norms,
    covariance_of_free_runs,
    norms_of_squares,
)
from dea.narx.scaling import Scaling
from dea.narx.simulation import BOUND, input_rows, simulate, structure
from dea.store import Record
from dea.terms import Term

_SMOOTHED = 9  # samples over which outputs are smoothed for a second start
_ENDS = 2.0  # standard deviations either way, within which a run should be linear
_DAMPING = Damping(least=1e-13, most=1e12)  # of the regressors' unit energy


class ReducedRuns(NamedTuple):
    """Free runs whose slope is what starts and trends leave of it.

    ``slope`` (samples, parameters) is that of all runs, and ``follow`` (starts and trends,
    parameters) how starts and trends follow where the parameters move.
    """

    runs: list[FreeRun]
    slope: Array
    follow: Array


class Minimum(NamedTuple):
    """Parameters at a minimum of the simulated error."""

    parameters: Array  # (terms,)
    msse: float  # mean squared simulated error (6), normalised units


def refine(
    model: NarxModel,
    u: Signals | Record | Sequence[Record],
    y: Signals | None = None,
    *,
    iterations: int = 30,
) -> NarxModel:
    """Return ``model`` with the parameters that minimise its simulated error (6).

    Least squares minimises the one-step error instead, which noise on the output biases; this
    does not have that bias. Starts from the model's own parameters, and from an estimate on
    smoothed outputs; the better minimum is taken. The outputs from which each
    run starts are estimated too: measured ones carry noise, which would enter every later output.

    Parameters
    ----------
    u, y
        Measured records in physical units, as for :func:`dea.narx.estimate`.
    iterations
        Most Levenberg-Marquardt steps; it ends earlier at a minimum.

    Returns
    -------
    NarxModel
        Its covariance allows for residuals that are correlated in time, whether the noise enters
        the equation or the output: see :mod:`dea.narx.parameter_covariance`.

    Raises
    ------
    InputError
        If the records are not usable or unlike the model's own, or its free run on them diverges.
    """
    lag, count = model.max_lag, len(model.terms)
    inputs, outputs, labels = unpacked(u, y, lag, count)
    model.labels.refuse_other(labels)
    segments = normalised(as_segments(inputs, outputs, lag, count), model.scaling)
    fit = fit_free_runs(model.terms, model.parameters, segments, iterations)
    if not np.isfinite(fit.msse):
        raise InputError(
            "the free run of the model diverges on this record",
            field="model",
            remedy="Start from parameters with which it is stable, or choose other terms.",
        )
    start = _from_smoothed_outputs(model.terms, segments)
    other = fit_free_runs(model.terms, start, segments, iterations)
    best = min(fit, other, key=lambda each: each.msse)
    return model.with_parameters(best.parameters, best.covariance, best.withheld)


def estimate_refined(
    terms: Iterable[Term], u: Signals, y: Signals, *, scaling: Scaling | None = None
) -> NarxModel:
    """Return :func:`dea.narx.estimate` of the parameters, refined where its free run is stable.

    An unstable estimate is returned as it is: its simulations and errors are infinite.
    """
    model = estimate(terms, u, y, scaling=scaling)
    segments = normalised(as_segments(u, y), model.scaling)
    stable = np.isfinite(squared_error(model.terms, model.parameters, segments))
    return refine(model, u, y) if stable else model


def minimise(
    terms: tuple[Term, ...],
    start: Array,
    segments: Sequence[Segment],
    iterations: int = 30,
    tolerance: float = 1e-10,
) -> Minimum:
    """Minimise the simulated error over normalised segments from the parameters ``start``.

    Ends after ``iterations`` or when a step lowers the error by less than ``tolerance`` of it. A
    start from which the run diverges comes back with an infinite error.
    """
    objective = _FreeRuns(terms, segments)
    point = least_squares.minimise(
        objective, start.copy(), _DAMPING, iterations=iterations, tolerance=tolerance
    )
    return Minimum(point.x, point.cost / objective.samples)


def _from_smoothed_outputs(terms: tuple[Term, ...], segments: Sequence[Segment]) -> Array:
    """Return the least-squares estimate on outputs smoothed without a shift in time.

    Where the input is slow compared with the sampling, noise on the output dominates the one-step
    error and can take least squares far enough to end in another minimum; smoothing removes most of
    the noise and little else.
    """
    weights = np.hanning(_SMOOTHED + 2)[1:-1]
    weights /= weights.sum()
    cut = _SMOOTHED // 2
    smoothed = [
        (u[cut:-cut], np.convolve(y, weights, "valid"))
        for u, y in segments
        if y.size > _SMOOTHED + structure(terms).start + len(terms)
    ]
    if not smoothed:
        return np.zeros(len(terms))
    return least_squares_of(terms, smoothed).parameters


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
        objective, objective.initial(start), _DAMPING, iterations=iterations, tolerance=tolerance
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
            largest = max(largest, float(np.linalg.norm(apart) / np.linalg.norm(linear)))
    return largest


class _FreeRuns:
    """The simulated error over segments, linearised by exact sensitivities."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment]) -> None:
        self._whole = _Segments(terms, segments)
        self.samples = sum(part.stop - part.start for part in self._whole.scored)

    def evaluate(self, x: Array) -> Point[None]:
        return Point(x, self._whole.squared_error(x), None)

    def linearise(self, point: Point[None], iteration: int, exact: bool) -> Model | None:
        error, residual, slope = self._whole.linearise(point.x)
        if not np.isfinite(error):
            return None
        return _damped(error, [(residual, slope, np.empty((residual.size, 0)))])


class _FreeRunsFromFreeStarts:
    """The same with the start of each run and its trend among the unknowns, after theta."""

    def __init__(
        self, terms: tuple[Term, ...], segments: Sequence[Segment], trend: int = 0
    ) -> None:
        self.terms, self._segments = terms, segments
        self._lag = structure(terms).start
        self._trends = [_powers(y.size, trend) for _, y in segments]
        self._own = self._lag + trend  # unknowns of each segment
        self._bound = _bound(segments)
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
        return _damped(float(sum(residual @ residual for residual, _, _ in runs)), runs)

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


def _damped(error: float, runs: Sequence[tuple[Array, Array, Array]]) -> Model:
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


def squared_error(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> float:
    """Sum of squared errors of the free runs; infinite where one diverges."""
    return _Segments(terms, segments).squared_error(theta)


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
    return _Segments(terms, segments).linearise(theta)


class _Segments:
    """Segments end to end, as one call of a kernel runs through them; each from its own outputs."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment]) -> None:
        self._shape = structure(terms)
        self._u = np.concatenate([input_rows(terms, u).ravel() for u, _ in segments])
        self._y = np.concatenate([y for _, y in segments])
        self._ends = np.cumsum([y.size for _, y in segments], dtype=np.int64)
        self._bounds = np.full(len(segments), _bound(segments))
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


def _bound(segments: Sequence[Segment]) -> float:
    """Return the output beyond which a run diverges; one segment may be at rest throughout."""
    return DIVERGED * max(float(np.abs(y).max()) for _, y in segments)
