"""Tracking by the simulated error: the Kalman smoother on a linearised free run.

Least squares and the Kalman filter regress on measured outputs, whose noise biases them, most
when the sampling is fast. A free run uses no measured outputs. Around a trajectory theta^0_t
with free run y^0_t and sensitivity psi_t,

    z_t = y_t - y^0_t + psi_t theta^0_t = psi_t theta_t + e_t,

so the random-walk smoother applies with psi in the place of phi and z in the place of y. Repeated
around its own result this is the Gauss-Newton iteration for the parameters whose free run comes
closest to the measured output, with a penalty on their rate of change: an iterated Kalman smoother,
B. M. Bell, SIAM Journal on Optimization 4 (1994).

The smoother takes e_t for white. What remains of the free run tells how the noise is correlated
(:func:`dea.narx.noise_model`); passed through the inverse of that model, z and psi make a
regression with white noise, of the same parameters as long as these change slowly. This is smoothed
until no parameter moves by a notable part of its standard deviation: the likelihood of the noise
ratios, the estimate and its covariance then hold for the noise that the record has.

Where the free run loses by that, its error is more than noise: the structure lacks something, and
the parameters that fit the free run best are kept, without a covariance that holds.

psi_t assumes that theta was theta_t throughout the memory of the system. Where a pole is so close
to one that parameters change within that time, the step does not lower the error of the free run;
only steps that do are taken, so the result is then the start itself.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.autoregression import whiten
from dea.narx import (
    FreeRun,
    NarxModel,
    feedback_slope,
    noise_model,
    regressor_matrix,
    remove_feedback,
    simulate_varying,
)
from dea.tracking.kalman import NOWHERE, Smoothed
from dea.tracking.random_walk import RandomWalk, lead_in
from dea.tracking.sensitivity import sensitivity

_ITERATIONS = 5
_SMALLEST_STEP = 1.0 / 64.0
_SMALLEST_FALL = 0.01  # share of the squared error; a smaller fall ends the iteration
_WHITENINGS = 10
_NOISE_FITS = 2  # of them that fit noise model and ratios anew
_LARGEST_RISE = 1.1  # of the squared error, for what a step fitted to the noise's correlation
_SETTLED = 0.1  # standard deviations; where no parameter moves further the iteration ends


class Tracked(NamedTuple):
    """Parameters whose free run fits the record, of the samples after the largest lag.

    ``reached`` says whether they are a minimum of the free run's error, and not the start because
    every step away from it raised that error; ``settled`` whether the covariance is that of the
    noise that the record has, at parameters that further iterations leave where they are.
    """

    smoothed: Smoothed
    reached: bool
    settled: bool


def smooth_simulation(
    model: NarxModel,
    start: Smoothed,
    u: Array,
    y: Array,
    walk: RandomWalk,
    at: NDArray[np.int64] = NOWHERE,
) -> Tracked:
    """Return the parameters whose free run fits the record.

    Parameters
    ----------
    start
        Parameters to linearise around at first, of the samples after the largest lag; their free
        run is bounded.
    u, y
        Normalised record, shape (samples,); a missing output is NaN, but among the first ones.
    walk
        Random-walk model of the parameters; ratios it does not give are fitted in each iteration.
    at
        Samples after the largest lag at which the whole covariance is kept.
    """
    best = start
    run, error = free_run(model, best.theta, u, y)
    for _ in range(_ITERATIONS):
        psi, z = _linearised(model, best.theta, u, y, run)
        found = walk.smooth(psi, z, model.parameters, at)
        step, before = 1.0, error
        while step >= _SMALLEST_STEP:
            moved = best.theta + step * (found.theta - best.theta)
            moved_run, error = free_run(model, moved, u, y)
            if error < before:
                break
            step /= 2.0
        else:
            error = before
            break
        best, run = found._replace(theta=moved), moved_run
        if error > (1.0 - _SMALLEST_FALL) * before:
            break
    smoothed, settled = _smooth_whitened(model, best, u, y, walk, at)
    return Tracked(smoothed, smoothed is not start, settled)


def _smooth_whitened(
    model: NarxModel, start: Smoothed, u: Array, y: Array, walk: RandomWalk, at: NDArray[np.int64]
) -> tuple[Smoothed, bool]:
    """Smooth around ``start`` with the noise that its free run leaves made white.

    Returns
    -------
    tuple
        ``start`` itself where nothing was found that fits nearly as well, and whether it settled.
    """
    best, lag = start, model.max_lag
    run, error = free_run(model, best.theta, u, y)
    largest, given = _LARGEST_RISE * error, walk
    for iteration in range(_WHITENINGS):
        if iteration < _NOISE_FITS:
            left = FreeRun(u, run, y - run, np.empty((0, 0)))
            (feedback,), noise = noise_model(model.terms, lead_in(best.theta, lag), [left])
        in_equation = bool(np.any(feedback))
        psi, z = _linearised(model, best.theta, u, y, run, in_equation)
        psi, z = whiten(noise, psi), whiten(noise, z)
        found = walk.smooth(psi, z, model.parameters, at)
        found_run, found_error = free_run(model, found.theta, u, y)
        if not found_error < largest:
            break
        near = _SETTLED * np.sqrt(np.maximum(found.variance, 0.0))
        close = bool(np.all(np.abs(found.theta - best.theta) <= near))
        best, run = found, found_run
        if iteration == _NOISE_FITS - 1 and walk.noise_ratio is None:
            walk = replace(walk, noise_ratio=found.noise_ratio)
        elif iteration >= _NOISE_FITS and close:
            covariance = given.covariance(psi, z, model.parameters, found, at)
            return found._replace(covariance=covariance), True
    return best, False


def _linearised(
    model: NarxModel, theta: Array, u: Array, y: Array, run: Array, in_equation: bool = False
) -> tuple[Array, Array]:
    """Return psi and z around a trajectory and its free run.

    With noise in the equation both are passed back through the feedback of the run, which leaves
    its regressors in the place of their sensitivities: exact however fast the parameters change.
    """
    lag = model.max_lag
    whole, error = lead_in(theta, lag), y - run
    if in_equation:
        psi = np.ascontiguousarray(regressor_matrix(model.terms, u, run))
        error = remove_feedback(feedback_slope(model.terms, whole, u, run), error)
    else:
        psi = sensitivity(model.terms, whole, u, run)
    return psi, error[lag:] + np.sum(psi * theta, axis=1)


def free_run(model: NarxModel, theta: Array, u: Array, y: Array) -> tuple[Array, float]:
    """Return the free run with ``theta`` after the largest lag, and its mean squared error."""
    run = simulate_varying(model.terms, lead_in(theta, model.max_lag), u, y)
    squares = (run - y) ** 2
    return run, float(np.mean(squares[~np.isnan(squares)]))
