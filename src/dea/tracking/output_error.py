"""Tracking by the simulated error: the Kalman smoother on a linearised free run.

Least squares and the Kalman filter regress on measured outputs, whose noise biases them, most
when the sampling is fast. A free run uses no measured outputs. Around a trajectory theta^0_t
with free run y^0_t and sensitivity psi_t,

    z_t = y_t - y^0_t + psi_t theta^0_t = psi_t theta_t + e_t,

so the random-walk smoother applies with psi in the place of phi and z in the place of y. Repeated
around its own result this is the Gauss-Newton iteration for the parameters whose free run comes
closest to the measured output, with a penalty on their rate of change: an iterated Kalman smoother,
B. M. Bell, SIAM Journal on Optimization 4 (1994).

psi_t assumes that theta was theta_t throughout the memory of the system. Where a pole is so close
to one that parameters change within that time, the step does not lower the error of the free run;
only steps that do are taken, so the result is then the start itself.
"""

import numpy as np
from numpy.typing import NDArray

from dea.narx import NarxModel, simulate_varying
from dea.tracking.kalman import Smoothed
from dea.tracking.random_walk import RandomWalk, lead_in
from dea.tracking.sensitivity import sensitivity

Array = NDArray[np.float64]

_ITERATIONS = 5
_SMALLEST_STEP = 1.0 / 64.0
_SMALLEST_FALL = 0.01  # share of the squared error; a smaller fall ends the iteration


def smooth_simulation(
    model: NarxModel, start: Smoothed, u: Array, y: Array, walk: RandomWalk
) -> Smoothed:
    """Return the parameters whose free run fits the record.

    Parameters
    ----------
    start
        Parameters to linearise around at first, of the samples after the largest lag; their free
        run is bounded.
    u, y
        Normalised record, shape (samples,).
    walk
        Random-walk model of the parameters; ratios it does not give are fitted in each iteration.

    Returns
    -------
    Smoothed
        Of the samples after the largest lag.
    """
    best, lag = start, model.max_lag
    run, error = free_run(model, best.theta, u, y)
    for _ in range(_ITERATIONS):
        psi = sensitivity(model.terms, lead_in(best.theta, lag), u, run)
        z = y[lag:] - run[lag:] + np.sum(psi * best.theta, axis=1)
        found = walk.smooth(psi, z, model.parameters)
        step, before = 1.0, error
        while step >= _SMALLEST_STEP:
            moved = best.theta + step * (found.theta - best.theta)
            moved_run, error = free_run(model, moved, u, y)
            if error < before:
                break
            step /= 2.0
        else:
            return best
        best, run = found._replace(theta=moved), moved_run
        if error > (1.0 - _SMALLEST_FALL) * before:
            break
    return best


def free_run(model: NarxModel, theta: Array, u: Array, y: Array) -> tuple[Array, float]:
    """Return the free run with ``theta`` after the largest lag, and its mean squared error."""
    run = simulate_varying(model.terms, lead_in(theta, model.max_lag), u, y)
    return run, float(np.mean((run - y) ** 2))
