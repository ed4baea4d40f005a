"""Parameters that minimise the simulated error: Levenberg-Marquardt on exact sensitivities."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dea import least_squares
from dea.arrays import Array, Segment
from dea.errors import InputError
from dea.least_squares import Model, Point
from dea.narx.estimation import as_segments, estimate, normalised
from dea.narx.estimation import least_squares as least_squares_of
from dea.narx.free_run_fit import DAMPING, damped, fit_free_runs
from dea.narx.labels import Signals, unpacked
from dea.narx.model import NarxModel
from dea.narx.scaling import Scaling
from dea.narx.segments import Segments, squared_error
from dea.narx.simulation import structure
from dea.store import Record
from dea.terms import Term

_SMOOTHED = 9  # samples over which outputs are smoothed for a second start


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
    inputs, outputs, _ = unpacked(u, y, lag, count, model.labels)
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
        objective, start.copy(), DAMPING, iterations=iterations, tolerance=tolerance
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


class _FreeRuns:
    """The simulated error over segments, linearised by exact sensitivities."""

    def __init__(self, terms: tuple[Term, ...], segments: Sequence[Segment]) -> None:
        self._whole = Segments(terms, segments)
        self.samples = sum(part.stop - part.start for part in self._whole.scored)

    def evaluate(self, x: Array) -> Point[None]:
        return Point(x, self._whole.squared_error(x), None)

    def linearise(self, point: Point[None], iteration: int, exact: bool) -> Model | None:
        error, residual, slope = self._whole.linearise(point.x)
        if not np.isfinite(error):
            return None
        return damped(error, [(residual, slope, np.empty((residual.size, 0)))])
