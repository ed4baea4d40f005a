"""Covariance of parameters that minimise the simulated error, whatever noise the record holds.

The error e_t of the free run is what the noise leaves in the output. Two models of it are fitted,
and the one of larger likelihood is taken:

    output noise      e_t = v_t
    equation noise    e_t = sum_l (df/dy_{t-l}) e_{t-l} + v_t

where v is autoregressive, its order found by the Bayesian information criterion. The second is how
noise in the equation reaches the output to first order: through the model's own dynamics, which
change with input and output. With Omega the covariance of e over the record, the covariance of the
estimate is G^-1 (psi^T Omega psi) G^-1, G = psi^T psi, with psi the derivative of the free run.
Omega is known by its root, so that psi^T Omega psi is the energy of psi passed backwards in time
through the noise model: L. Ljung, System Identification (1999), section 9.4. A kernel estimate over
lagged products, as Newey and West's, needs no noise model, but is too small where correlation lasts
for more than a few percent of the record.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.autoregression import Autoregression, fit_autoregression, noise_energy
from dea.narx.regressors import regressor_matrix
from dea.terms import Term, max_lag

DEPENDENT = 1e-14  # share of the largest eigenvalue of the scaled information that is rounding


class FreeRun(NamedTuple):
    """A free run over one segment, normalised."""

    u: Array  # (samples,) or (samples, inputs)
    output: Array  # (samples,)
    residual: Array  # (samples,) measured less simulated
    slope: Array  # (samples, parameters) derivative of the output


def covariance_of_free_runs(
    terms: Sequence[Term], theta: Array, runs: Sequence[FreeRun], unknowns: int
) -> Array:
    """Return the covariance (terms, terms) of the parameters at a minimum of the simulated error.

    Parameters
    ----------
    theta
        Parameters, shape (terms,).
    runs
        Where each run has unknowns of its own, such as its start, its slope is the part of the
        derivative by the parameters that is orthogonal to the derivatives by these.
    unknowns
        All that were fitted.
    """
    norms = column_norms(np.vstack([run.slope for run in runs]))
    scaled = [run.slope / norms for run in runs]
    information = sum((slope.T @ slope for slope in scaled), np.zeros((norms.size, norms.size)))
    inverse = np.linalg.pinv(information, rcond=DEPENDENT, hermitian=True)
    feedback, noise = noise_model(terms, theta, runs)
    energy = np.zeros_like(information)
    for slope, fed_back in zip(scaled, feedback, strict=True):
        energy += noise_energy(noise, _backwards(fed_back, slope))
    count = sum(run.residual.size for run in runs)
    freedom = count / max(count - unknowns, 1)
    found: Array = freedom * (inverse @ energy @ inverse) / np.outer(norms, norms)
    return found


def noise_model(
    terms: Sequence[Term], theta: Array, runs: Sequence[FreeRun]
) -> tuple[list[Array], Autoregression]:
    """Return the feedback df/dy of each run, zero where noise is on the output, and the noise.

    The feedback has shape (samples, largest lag + 1); its column l belongs to y_{t-l}.
    """
    lag = max_lag(terms)
    through = [feedback_slope(terms, theta, run.u, run.output) for run in runs]
    driving = [
        remove_feedback(slopes, run.residual) for run, slopes in zip(runs, through, strict=True)
    ]
    in_equation = fit_autoregression(driving)
    on_output = fit_autoregression([run.residual for run in runs])
    if in_equation.criterion < on_output.criterion:
        return through, in_equation
    return [np.zeros((run.residual.size, lag + 1)) for run in runs], on_output


def feedback_slope(terms: Sequence[Term], theta: Array, u: Array, y: Array) -> Array:
    """Return df/dy_{t-l} along a run in column l, shape (samples, largest lag + 1).

    Zero in the samples before the largest lag. ``theta`` has shape (terms,) or (samples, terms).
    """
    start = max_lag(terms)
    feedback = np.zeros((y.size, start + 1))
    parameters = np.broadcast_to(theta, (y.size, len(terms)))
    for j, term in enumerate(terms):
        for lag, power in Counter(term.y_lags).items():
            others = list(term.y_lags)
            others.remove(lag)
            slope = regressor_matrix((term._replace(y_lags=tuple(others)),), u, y, start)[:, 0]
            feedback[start:, lag] += parameters[start:, j] * power * slope
    return feedback


def column_norms(matrix: Array) -> Array:
    """Norm of each column, 1 for a column of zeros."""
    return norms_of_squares(np.einsum("ij,ij->j", matrix, matrix))


def norms_of_squares(squares: Array) -> Array:
    """Norms from sums of squares, 1 for a sum of zero."""
    norms = np.sqrt(squares)
    return np.where(norms > 0.0, norms, 1.0)


def remove_feedback(feedback: Array, error: Array) -> Array:
    """Return error_t - sum_l feedback[t, l] error_{t-l}, what noise in the equation was."""
    driving = error.copy()
    for lag in range(1, feedback.shape[1]):
        driving[lag:] -= feedback[lag:, lag] * error[:-lag]
    return driving


@njit(cache=True)
def _backwards(feedback: Array, slope: Array) -> Array:
    """Solve (I - F)^T g = slope, F the feedback matrix: the adjoint of e = F e + v."""
    adjoint = slope.copy()
    samples, lags = feedback.shape
    for t in range(samples - 1, -1, -1):
        for lag in range(1, min(lags, samples - t)):
            if feedback[t + lag, lag] != 0.0:
                for j in range(adjoint.shape[1]):
                    adjoint[t, j] += feedback[t + lag, lag] * adjoint[t + lag, j]
    return adjoint
