"""Random-walk Kalman filter and smoother with noise ratios fitted by likelihood.

    theta_t = theta_{t-1} + w_t,   w_t ~ N(0, sigma^2 diag(q))
    y_t     = phi_t theta_t + e_t, e_t ~ N(0, sigma^2)

All covariances below are in units of sigma^2, which is concentrated out of the likelihood, so the
unknowns are the ratios q alone, one for each parameter: some parameters of a system drift and
others stand still, and a common ratio would let the standing ones follow noise.

The smoother is the Rauch-Tung-Striebel estimate in the form of Bryson and Frazier, whose backward
pass needs no inverse, so that ratios of zero (constant parameters) are nothing special. Its
adjoints also give the exact gradient of the likelihood: S. J. Koopman and N. Shephard, Exact score
for time series models in state space form, Biometrika 79 (1992).
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.errors import InputError

Array = NDArray[np.float64]


class Smoothed(NamedTuple):
    """What the smoother finds in n samples of p regressors.

    ``theta`` and ``variance`` (n, p) are means and variances given the whole record,
    ``filtered`` (n, p) the means given the record up to each sample, ``innovation`` (n,) the
    one-step prediction errors, ``noise_ratio`` (p,) the q used and ``noise_variance`` sigma^2.
    """

    theta: Array
    variance: Array
    filtered: Array
    innovation: Array
    noise_ratio: Array
    noise_variance: float


def smooth(
    Phi: Array, y: Array, noise_ratio: Array, *, theta_0: Array, prior_variance: Array | float
) -> Smoothed:
    """Estimate parameters that walk randomly, at every sample from the whole record.

    Parameters
    ----------
    Phi, y
        Regressors (n, p) and outputs (n,); a sample whose output is NaN is passed over.
    noise_ratio
        q, shape (p,): variance of a parameter's step over that of the noise.
    theta_0, prior_variance
        Mean (p,) and variance (p,) of the parameters before the first sample; the variance in
        units of sigma^2.
    """
    Phi, y, q, theta_0, prior = _arrays(Phi, y, noise_ratio, theta_0, prior_variance)
    predicted, P, gain, innovation, S = _filter(Phi, y, q, theta_0, prior)
    _, sigma2 = _concentrated(innovation, S)
    theta, variance = _smoother(Phi, predicted, P, gain, innovation, S)
    filtered = predicted + gain * np.nan_to_num(innovation)[:, None]
    return Smoothed(theta, sigma2 * variance, filtered, innovation, q, sigma2)


def log_likelihood(
    Phi: Array, y: Array, noise_ratio: Array, *, theta_0: Array, prior_variance: Array | float
) -> tuple[float, Array]:
    """Return the log-likelihood of q, sigma^2 concentrated out, and its gradient by q.

    Parameters are those of :func:`smooth`; constants that do not depend on q are left out.
    """
    arrays = _arrays(Phi, y, noise_ratio, theta_0, prior_variance)
    gain, innovation, S = _innovations(*arrays)
    value, sigma2 = _concentrated(innovation, S)
    return value, _score(arrays[0], gain, innovation, S, sigma2)


def fit_noise_ratio(
    Phi: Array,
    y: Array,
    *,
    theta_0: Array,
    prior_variance: Array | float,
    thinning: int = 1,
    lowest: float = 1e-14,
    highest: float = 1e-2,
) -> Array:
    """Return the noise ratios of largest likelihood, shape (p,).

    The best common ratio is found first; from it, log q is refined for each parameter with the
    exact gradient. A ratio that ends at ``lowest`` is as good as constant.

    Parameters
    ----------
    thinning
        Only every so many samples enter. The errors of neighbouring samples are alike, since noise
        and what a model misses pass through the same dynamics; the likelihood takes them for
        independent and would read their likeness as parameters on the move.
    lowest, highest
        Between which the ratios are sought.

    Other parameters are those of :func:`smooth`.
    """
    from scipy.optimize import minimize, minimize_scalar

    # A parameter walks `thinning` steps between the samples that are left.
    Phi, y = np.ascontiguousarray(Phi[::thinning]), np.ascontiguousarray(y[::thinning])
    p, count = Phi.shape[1], y.size

    def cost(log_q: Array) -> tuple[float, Array]:
        q = np.exp(log_q)
        value, gradient = log_likelihood(Phi, y, q, theta_0=theta_0, prior_variance=prior_variance)
        return -value / count, -gradient * q / count

    def common_cost(log_q: float) -> float:
        arrays = _arrays(Phi, y, np.full(p, np.exp(log_q)), theta_0, prior_variance)
        _, innovation, S = _innovations(*arrays)
        return -_concentrated(innovation, S)[0] / count

    bounds = (np.log(thinning * lowest), np.log(thinning * highest))
    common = minimize_scalar(common_cost, bounds=bounds, method="bounded", options={"xatol": 0.3})
    found = minimize(
        cost,
        np.full(p, common.x),
        jac=True,
        bounds=[bounds] * p,
        method="L-BFGS-B",
        options={"maxiter": 30, "ftol": 1e-7},
    )
    return np.exp(found.x) / thinning


def _concentrated(innovation: Array, S: Array) -> tuple[float, float]:
    """Return the log-likelihood with sigma^2 at its best value, and that value."""
    seen = np.isfinite(innovation)
    sigma2 = float(np.mean(innovation[seen] ** 2 / S[seen]))
    return float(-0.5 * (seen.sum() * np.log(sigma2) + np.log(S[seen]).sum())), sigma2


def _arrays(
    Phi: Array, y: Array, noise_ratio: Array, theta_0: Array, prior_variance: Array | float
) -> tuple[Array, Array, Array, Array, Array]:
    Phi, y = np.ascontiguousarray(Phi, dtype=float), np.ascontiguousarray(y, dtype=float)
    p = Phi.shape[1]
    q = np.array(np.broadcast_to(noise_ratio, p), dtype=float)
    prior = np.array(np.broadcast_to(prior_variance, p), dtype=float)
    if np.any(q < 0.0) or np.any(prior < 0.0):
        raise InputError("a variance is negative", field="noise_ratio or prior_variance")
    return Phi, y, q, np.array(theta_0, dtype=float), prior


@njit(cache=True)
def _step(phi: Array, y: float, theta: Array, P: Array, K: Array) -> tuple[float, float]:
    """Condition theta and P on one output; write the gain and return innovation and its variance.

    Only a sum and a product in the same order make P[i, k] and P[k, i], so P stays symmetric.
    """
    p = phi.size
    if np.isnan(y):
        K[:] = 0.0
        return np.nan, 1.0
    S, innovation = 1.0, y
    for i in range(p):
        total = 0.0
        for k in range(p):
            total += P[i, k] * phi[k]
        K[i] = total
        S += phi[i] * total
        innovation -= phi[i] * theta[i]
    for i in range(p):
        for k in range(i + 1):
            P[i, k] -= K[i] * K[k] / S
            P[k, i] = P[i, k]
    for i in range(p):
        K[i] /= S
        theta[i] += K[i] * innovation
    return innovation, S


@njit(cache=True)
def _innovations(
    Phi: Array, y: Array, q: Array, theta_0: Array, prior: Array
) -> tuple[Array, Array, Array]:
    """Run the filter; keep gains, innovations and their variances."""
    n, p = Phi.shape
    gain, innovation, S = np.empty((n, p)), np.empty(n), np.empty(n)
    theta, P = theta_0.copy(), np.diag(prior)
    for t in range(n):
        for i in range(p):
            P[i, i] += q[i]
        innovation[t], S[t] = _step(Phi[t], y[t], theta, P, gain[t])
    return gain, innovation, S


@njit(cache=True)
def _filter(
    Phi: Array, y: Array, q: Array, theta_0: Array, prior: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """Run the filter; keep the predicted means and covariances as well."""
    n, p = Phi.shape
    predicted, covariance = np.empty((n, p)), np.empty((n, p, p))
    gain, innovation, S = np.empty((n, p)), np.empty(n), np.empty(n)
    theta, P = theta_0.copy(), np.diag(prior)
    for t in range(n):
        for i in range(p):
            P[i, i] += q[i]
        predicted[t] = theta
        covariance[t] = P
        innovation[t], S[t] = _step(Phi[t], y[t], theta, P, gain[t])
    return predicted, covariance, gain, innovation, S


@njit(cache=True)
def _adjoint_step(
    phi: Array, K: Array, innovation: float, S: float, r: Array, N: Array, NK: Array
) -> None:
    """Take r_t, N_t to r_{t-1}, N_{t-1}: r = phi v/S + L^T r, N = phi phi^T/S + L^T N L.

    L = I - K phi^T; K is zero and nothing changes where the output is missing.
    """
    if np.isnan(innovation):
        return
    p = phi.size
    Kr, KNK = 0.0, 0.0
    for i in range(p):
        total = 0.0
        for k in range(p):
            total += N[i, k] * K[k]
        NK[i] = total
        KNK += K[i] * total
        Kr += K[i] * r[i]
    for i in range(p):
        r[i] += phi[i] * (innovation / S - Kr)
        for k in range(i + 1):
            N[i, k] += phi[i] * phi[k] * (1.0 / S + KNK) - phi[i] * NK[k] - NK[i] * phi[k]
            N[k, i] = N[i, k]


@njit(cache=True)
def _smoother(
    Phi: Array, predicted: Array, P: Array, gain: Array, innovation: Array, S: Array
) -> tuple[Array, Array]:
    """theta_{t|N} = theta_{t|t-1} + P r and var_{t|N} = diag(P - P N P), P = P_{t|t-1}."""
    n, p = Phi.shape
    theta, variance = np.empty((n, p)), np.empty((n, p))
    r, N, NK = np.zeros(p), np.zeros((p, p)), np.empty(p)
    for t in range(n - 1, -1, -1):
        _adjoint_step(Phi[t], gain[t], innovation[t], S[t], r, N, NK)
        for i in range(p):
            shift, fall = 0.0, 0.0
            for k in range(p):
                shift += P[t, i, k] * r[k]
                total = 0.0
                for m in range(p):
                    total += N[k, m] * P[t, i, m]
                fall += P[t, i, k] * total
            theta[t, i] = predicted[t, i] + shift
            variance[t, i] = P[t, i, i] - fall
    return theta, variance


@njit(cache=True)
def _score(Phi: Array, gain: Array, innovation: Array, S: Array, sigma2: float) -> Array:
    """d log L/dq_i = 1/2 sum_t (r_{t-1,i}^2/sigma^2 - N_{t-1,ii})."""
    n, p = Phi.shape
    score = np.zeros(p)
    r, N, NK = np.zeros(p), np.zeros((p, p)), np.empty(p)
    for t in range(n - 1, -1, -1):
        _adjoint_step(Phi[t], gain[t], innovation[t], S[t], r, N, NK)
        for i in range(p):
            score[i] += 0.5 * (r[i] * r[i] / sigma2 - N[i, i])
    return score
