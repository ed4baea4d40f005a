"""Random-walk Kalman filter and smoother with noise ratios fitted by likelihood.

    theta_t = theta_{t-1} + w_t,   w_t ~ N(0, sigma^2 diag(q))
    y_t     = phi_t theta_t + e_t, e_t ~ N(0, sigma^2)

All covariances below are in units of sigma^2, which is concentrated out of the likelihood, so the
unknowns are the ratios q alone, one for each parameter: some parameters of a system drift and
others are constant, and a common ratio would let the constant ones follow noise.

The smoother is the Rauch-Tung-Striebel estimate in the form of Bryson and Frazier, whose backward
pass needs no inverse, so that ratios of zero (constant parameters) need no special treatment. Its
adjoints also give the exact gradient of the likelihood: S. J. Koopman and N. Shephard, Exact score
for time series models in state space form, Biometrika 79 (1992).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.narx import check_shape
from dea.tracking.kalman_passes import Filtered, run_filter, run_smoother, score

NOWHERE = np.empty(0, dtype=np.int64)
LOWEST_RATIO, HIGHEST_RATIO = 1e-14, 1e-2  # bounds of the noise ratios


class Prior(NamedTuple):
    """What is known of p parameters before the first sample.

    ``mean`` (p,), and ``variance`` (p,), or one for all, in units of sigma^2.
    """

    mean: Array
    variance: Array | float


class Smoothed(NamedTuple):
    """What the smoother finds in n samples of p regressors.

    ``theta`` and ``variance`` (n, p) are means and variances given the whole record,
    ``covariance`` (k, p, p) the whole covariances at the samples asked for, ``filtered`` (n, p) the
    means given the record up to each sample, ``innovation`` (n,) the one-step prediction errors,
    ``noise_ratio`` (p,) the q used and ``noise_variance`` sigma^2.
    """

    theta: Array
    variance: Array
    covariance: Array
    filtered: Array
    innovation: Array
    noise_ratio: Array
    noise_variance: float


def smooth(
    Phi: Array,
    y: Array,
    noise_ratio: Array,
    prior: Prior,
    at: NDArray[np.int64] = NOWHERE,
) -> Smoothed:
    """Estimate parameters that walk randomly, at every sample from the whole record.

    Parameters
    ----------
    Phi, y
        Regressors (n, p) and outputs (n,); a sample whose output is NaN is skipped.
    noise_ratio
        q, shape (p,): variance of a parameter's step over that of the noise.
    prior
        Of the parameters.
    at
        Samples, ascending, at which the whole covariance is kept.

    Raises
    ------
    InputError
        If a variance is negative or not finite, or a shape does not fit Phi's.
    """
    Phi, y, q, theta_0, P_0 = _arrays(Phi, y, noise_ratio, prior)
    forward = run_filter(Phi, y, q, theta_0, P_0, True)
    innovation = forward.innovation
    _, sigma2 = _concentrated(forward)
    instants = np.asarray(at, dtype=np.int64)
    theta, variance, N = run_smoother(Phi, forward, instants)
    P = forward.P[instants]
    smoothed = P - P @ N @ P
    covariance = 0.5 * (smoothed + smoothed.transpose(0, 2, 1))
    filtered = forward.theta + forward.gain * np.nan_to_num(innovation)[:, None]
    return Smoothed(theta, sigma2 * variance, sigma2 * covariance, filtered, innovation, q, sigma2)


def log_likelihood(Phi: Array, y: Array, noise_ratio: Array, prior: Prior) -> tuple[float, Array]:
    """Return the log-likelihood of q, sigma^2 concentrated out, and its gradient (p,) by q.

    Parameters are those of :func:`smooth`; constants that do not depend on q are left out.
    """
    arrays = _arrays(Phi, y, noise_ratio, prior)
    forward = run_filter(*arrays, False)
    value, sigma2 = _concentrated(forward)
    return value, score(arrays[0], forward, sigma2)


def likelihood(Phi: Array, y: Array, noise_ratio: Array, prior: Prior) -> float:
    """Return the value of :func:`log_likelihood` without its gradient, a second pass."""
    return _concentrated(run_filter(*_arrays(Phi, y, noise_ratio, prior), False))[0]


def fit_noise_ratio(
    Phi: Array,
    y: Array,
    prior: Prior,
    *,
    thinning: int = 1,
    bounds: tuple[float, float] = (LOWEST_RATIO, HIGHEST_RATIO),
) -> Array:
    """Return the noise ratios of largest likelihood, shape (p,).

    The best common ratio is found first; from it, log q is refined for each parameter with the
    exact gradient. A ratio that ends at the lower bound is practically that of a constant
    parameter.

    Parameters
    ----------
    thinning
        Only every ``thinning``-th sample enters. The errors of neighbouring samples are correlated,
        since noise and unmodelled effects pass through the same dynamics; the likelihood assumes
        independence and would explain the correlation by moving parameters.
    bounds
        Of the ratios.

    Other parameters are those of :func:`smooth`.
    """
    from scipy.optimize import minimize

    check_shape(y, (len(Phi),), "y")
    common = _common_ratio(Phi, y, prior, thinning, bounds)
    # A parameter takes `thinning` steps between the samples that are used.
    Phi, y = thinned(Phi, y, thinning)
    p, count = Phi.shape[1], y.size

    def cost(log_q: Array) -> tuple[float, Array]:
        q = np.exp(log_q)
        value, gradient = log_likelihood(Phi, y, q, prior)
        return -value / count, -gradient * q / count

    found = minimize(
        cost,
        np.full(p, np.log(common * thinning)),
        jac=True,
        bounds=[_log_bounds(bounds, thinning)] * p,
        method="L-BFGS-B",
        options={"maxiter": 30, "ftol": 1e-7},
    )
    ratios: Array = np.exp(found.x) / thinning
    return ratios


def thinned(Phi: Array, y: Array, thinning: int) -> tuple[Array, Array]:
    """Return every ``thinning``-th equation, from the one on at which most outputs are known."""
    known = [np.count_nonzero(np.isfinite(y[first::thinning])) for first in range(thinning)]
    chosen = slice(int(np.argmax(known)), None, thinning)
    return np.ascontiguousarray(Phi[chosen]), np.ascontiguousarray(y[chosen])


def _common_ratio(
    Phi: Array, y: Array, prior: Prior, thinning: int, bounds: tuple[float, float]
) -> float:
    """Return the one noise ratio of all parameters that has the largest likelihood.

    Parameters are those of :func:`fit_noise_ratio`.
    """
    from scipy.optimize import minimize_scalar

    Phi, y = thinned(Phi, y, thinning)

    def cost(log_q: float) -> float:
        q = np.full(Phi.shape[1], np.exp(log_q))
        return -likelihood(Phi, y, q, prior) / y.size

    found = minimize_scalar(
        cost, bounds=_log_bounds(bounds, thinning), method="bounded", options={"xatol": 0.3}
    )
    return float(np.exp(found.x)) / thinning


def _log_bounds(bounds: tuple[float, float], thinning: int) -> tuple[float, float]:
    """Return the logarithms of the bounds of ratios between the samples that are used."""
    lowest, highest = bounds
    return np.log(thinning * lowest), np.log(thinning * highest)


def _concentrated(forward: Filtered) -> tuple[float, float]:
    """Return the log-likelihood with sigma^2 at its best value, and that value."""
    innovation, S = forward.innovation, forward.variance
    seen = np.isfinite(innovation)
    sigma2 = float(np.mean(innovation[seen] ** 2 / S[seen]))
    return float(-0.5 * (seen.sum() * np.log(sigma2) + np.log(S[seen]).sum())), sigma2


def _arrays(
    Phi: Array, y: Array, noise_ratio: Array, prior: Prior
) -> tuple[Array, Array, Array, Array, Array]:
    Phi, y = np.ascontiguousarray(Phi, dtype=float), np.ascontiguousarray(y, dtype=float)
    samples, p = Phi.shape
    check_shape(y, (samples,), "y")
    check_shape(prior.mean, (p,), "prior_mean")
    q = np.array(np.broadcast_to(noise_ratio, p), dtype=float)
    P_0 = np.array(np.broadcast_to(prior.variance, p), dtype=float)
    for field, variances in (("noise_ratio", q), ("prior_variance", P_0)):
        if not np.all(np.isfinite(variances) & (variances >= 0.0)):
            raise InputError(
                "a variance is negative or not finite",
                field=field,
                remedy="Give finite variances from 0 on",
            )
    return Phi, y, q, np.array(prior.mean, dtype=float), np.diag(P_0)
