"""Parameters that minimise the simulated error: Levenberg-Marquardt on exact sensitivities."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dea import least_squares
from dea.errors import InputError
from dea.least_squares import Damping, Model, Point
from dea.narx import kernels
from dea.narx.checks import Array
from dea.narx.estimation import Segment, Signals, as_segments, estimate, normalised
from dea.narx.model import NarxModel
from dea.narx.scaling import Scaling
from dea.narx.simulation import BOUND, simulate, structure
from dea.terms import Term

_DAMPING = Damping(least=1e-13, most=1e12)  # of the regressors' unit energy


class Refined(NamedTuple):
    """Parameters at a minimum of the simulated error."""

    parameters: Array  # (terms,)
    msse: float  # mean squared simulated error (6), normalised units


def refine(model: NarxModel, u: Signals, y: Signals, *, iterations: int = 30) -> NarxModel:
    """Return ``model`` with the parameters that minimise its simulated error (6).

    Least squares minimises the one-step error instead, which noise on the output biases; this
    does not have that bias. Starts from the model's own parameters.

    Parameters
    ----------
    u, y
        Measured records in physical units, as for :func:`dea.narx.estimate`.
    iterations
        Most Levenberg-Marquardt steps; it ends earlier at a minimum.

    Returns
    -------
    NarxModel
        Its covariance allows for residuals that are correlated in time.

    Raises
    ------
    InputError
        If the records are not usable or the model's free run on them diverges.
    """
    records = as_segments(u, y, model.max_lag, len(model.terms))
    segments = normalised(records, model.scaling)
    refined = minimise(model.terms, model.parameters, segments, iterations)
    if not np.isfinite(refined.msse):
        raise InputError(
            "the free run of the model diverges on this record",
            field="model",
            remedy="Start from parameters with which it is stable, or choose other terms.",
        )
    covariance = robust_covariance(model.terms, refined.parameters, segments)
    return model.with_parameters(refined.parameters, covariance)


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
) -> Refined:
    """Minimise the simulated error over normalised segments from the parameters ``start``.

    Ends after ``iterations`` or when a step lowers the error by less than ``tolerance`` of it. A
    start from which the run diverges comes back with an infinite error.
    """
    task = _FreeRuns(terms, segments)
    point = least_squares.minimise(
        task, start.copy(), _DAMPING, iterations=iterations, tolerance=tolerance
    )
    return Refined(point.x, point.cost / task.samples)


class _FreeRuns:
    """The simulated error over segments, linearised by exact sensitivities."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment]) -> None:
        self._terms, self._segments = terms, segments
        first = structure(terms).start
        self.samples = sum(y.size - first for _, y in segments)

    def evaluate(self, x: Array) -> Point[None]:
        return Point(x, squared_error(self._terms, x, self._segments), None)

    def linearise(self, point: Point[None], iteration: int, exact: bool) -> Model | None:
        error, residual, slope = linearise(self._terms, point.x, self._segments)
        if not np.isfinite(error):
            return None
        norms = column_norms(slope)
        scaled = slope / norms
        energy, directions = np.linalg.eigh(scaled.T @ scaled)
        energy = np.maximum(energy, 0.0)  # rounding may make a zero eigenvalue negative
        projected = directions.T @ (scaled.T @ residual)

        def step(damping: float) -> Array:
            moved: Array = (directions @ (projected / (energy + damping))) / norms
            return moved

        return Model(error, step)


def squared_error(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> float:
    """Sum of squared errors of the free runs; infinite where one diverges."""
    first = structure(terms).start
    total = 0.0
    for u, y in segments:
        run = simulate(terms, theta, u, y, bound=_bound(y))
        if not np.isfinite(run[-1]):
            return np.inf
        total += float(np.sum((y[first:] - run[first:]) ** 2))
    return total


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
    y = np.empty(u.size)
    y[: shape.start] = y_initial[: shape.start]
    slope = np.zeros((u.size, len(terms)))
    kernels.run_with_slope(shape, theta, u, y, slope, bound)
    return y, slope


def robust_covariance(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> Array:
    """Covariance at a minimum of the simulated error whose residuals are correlated in time.

    Newey and West (1987) with Bartlett weights over the first 4 (n/100)^(2/9) lags or, where that
    is longer, over ten times the lag at which the residual's autocorrelation has fallen to 1/e.
    """
    _, residual, slope = linearise(terms, theta, segments)
    norms = column_norms(slope)
    scaled = slope / norms
    inverse = np.linalg.pinv(scaled.T @ scaled, rcond=1e-14, hermitian=True)
    score = scaled * residual[:, None]
    count = residual.size
    reach = min(max(int(4.0 * (count / 100.0) ** (2 / 9)), 10 * _memory(residual)), count // 4)
    meat = score.T @ score
    for lag in range(1, reach + 1):
        cross = score[lag:].T @ score[:-lag]
        meat += (1.0 - lag / (reach + 1.0)) * (cross + cross.T)
    freedom = count / max(count - norms.size, 1)
    return freedom * (inverse @ meat @ inverse) / np.outer(norms, norms)


def column_norms(matrix: Array) -> Array:
    """Norm of each column, 1 for a column of zeros."""
    norms = np.sqrt(np.einsum("ij,ij->j", matrix, matrix))
    return np.where(norms > 0.0, norms, 1.0)


def _memory(residual: Array) -> int:
    """Lag at which the autocorrelation first falls below 1/e."""
    size = 2 * residual.size
    spectrum = np.fft.rfft(residual, size)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2, size)[: residual.size]
    return int(np.argmax(correlation <= correlation[0] / np.e))


class Linearised(NamedTuple):
    """The free runs at one point of the parameter space and their slope there."""

    error: float  # sum of squares; inf where a run diverges
    residual: Array  # (samples,) measured less simulated, all segments
    slope: Array  # (samples, terms) derivative of the run by each parameter


def linearise(terms: tuple[Term, ...], theta: Array, segments: Sequence[Segment]) -> Linearised:
    """Simulate every segment with its sensitivities."""
    first = structure(terms).start
    residuals, slopes = [], []
    for u, y in segments:
        run, slope = sensitivities(terms, theta, u, y, _bound(y))
        if not np.isfinite(run[-1]):
            return Linearised(np.inf, np.empty(0), np.empty((0, theta.size)))
        residuals.append(y[first:] - run[first:])
        slopes.append(slope[first:])
    residual = np.concatenate(residuals)
    slope = slopes[0] if len(slopes) == 1 else np.vstack(slopes)
    return Linearised(float(residual @ residual), residual, slope)


def _bound(y: Array) -> float:
    return 100.0 * float(np.abs(y).max())
