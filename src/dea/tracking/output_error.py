"""Tracking by the simulated error: the Kalman smoother on a linearised free run.

Least squares and the Kalman filter regress on measured outputs, whose noise biases them, worst
when the sampling is fast. A free run has no measured outputs in it. Around a trajectory theta^0_t
with free run y^0_t and sensitivity psi_t,

    z_t = y_t - y^0_t + psi_t theta^0_t = psi_t theta_t + e_t,

so the random-walk smoother applies with psi in the place of phi and z in the place of y. Repeated
around its own result this is the Gauss-Newton iteration for the parameters whose free run comes
closest to the measured output, penalised by how fast they walk: an iterated Kalman smoother,
B. M. Bell, SIAM Journal on Optimization 4 (1994).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.narx import NarxModel, simulate_varying
from dea.tracking.kalman import Smoothed
from dea.tracking.random_walk import RandomWalk, lead_in
from dea.tracking.sensitivity import sensitivity

Array = NDArray[np.float64]

_ITERATIONS = 5
_SMALLEST_STEP = 1.0 / 64.0
_SMALLEST_FALL = 0.01  # of the mean squared error, below which another iteration is not worth it


class _Run(NamedTuple):
    """Parameters of every sample, their free run and its mean squared error."""

    theta: Array
    y: Array
    error: float


def smooth_simulation(
    model: NarxModel, start: Array, u: Array, y: Array, walk: RandomWalk
) -> Smoothed:
    """Return the parameters whose free run fits the record.

    Parameters
    ----------
    start
        Parameters to linearise around at first, shape (samples, terms); their free run is bounded.
    u, y
        Normalised record, shape (samples,).
    walk
        How the parameters may walk; ratios that it leaves open are fitted in each iteration.

    Returns
    -------
    Smoothed
        Of the samples after the largest lag.
    """
    run = _simulate(model, start, u, y)
    for _ in range(_ITERATIONS):
        found = _smooth_around(model, run, u, y, walk)
        towards = lead_in(found.theta, model.max_lag)
        step = 1.0
        better = _simulate(model, towards, u, y)
        while not better.error < run.error and step > _SMALLEST_STEP:
            step /= 2.0
            better = _simulate(model, run.theta + step * (towards - run.theta), u, y)
        if not better.error < run.error:
            break
        fall, run = 1.0 - better.error / run.error, better
        if fall < _SMALLEST_FALL:
            break
    return found._replace(theta=run.theta[model.max_lag :])


def _smooth_around(model: NarxModel, run: _Run, u: Array, y: Array, walk: RandomWalk) -> Smoothed:
    psi = sensitivity(model.terms, run.theta, u, run.y)
    first = model.max_lag
    z = y[first:] - run.y[first:] + np.sum(psi * run.theta[first:], axis=1)
    return walk.smooth(psi, z, model.parameters)


def _simulate(model: NarxModel, theta: Array, u: Array, y: Array) -> _Run:
    simulated = simulate_varying(model.terms, theta, u, y)
    return _Run(theta, simulated, float(np.mean((simulated - y) ** 2)))
