"""Derivatives of a free run by its parameters when these change with time."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.narx import feedback_slope, regressor_matrix
from dea.terms import Term, max_lag


def sensitivity(terms: tuple[Term, ...], theta: Array, u: Array, y: Array) -> Array:
    """Return the derivative of each output of a free run by a constant change of each parameter.

    psi_t = phi_t + sum_l (df/dy_{t-l}) psi_{t-l}. For parameters that change slowly compared with
    the memory of the system this is the derivative of y_t by theta_t.

    Parameters
    ----------
    theta
        Parameters, shape (samples, terms).
    u, y
        Normalised input, and the output of the free run with ``theta``, shape (samples,).

    Returns
    -------
    ndarray
        Shape (samples - largest lag, terms).
    """
    feedback = feedback_slope(terms, theta, u, y)[max_lag(terms) :]
    psi = np.ascontiguousarray(regressor_matrix(terms, u, y))
    _accumulate(feedback, psi)
    return psi


@njit(cache=True)
def _accumulate(feedback: Array, psi: Array) -> None:
    for t in range(psi.shape[0]):
        for lag in range(1, min(t, feedback.shape[1] - 1) + 1):
            if feedback[t, lag] != 0.0:
                for j in range(psi.shape[1]):
                    psi[t, j] += feedback[t, lag] * psi[t - lag, j]
