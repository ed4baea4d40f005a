"""The passes of the Kalman smoother over a record, compiled: forward, and backward in adjoints.

Covariances are in units of the noise variance. A sample whose output is NaN is passed over.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.arrays import Array


class Filtered(NamedTuple):
    """What the filter finds in n samples of p regressors.

    ``gain`` (n, p), ``innovation`` and its ``variance`` (n,), and the predicted means ``theta``
    (n, p) and covariances ``P`` (n, p, p), which are empty where they were not kept.
    """

    gain: Array
    innovation: Array
    variance: Array
    theta: Array
    P: Array


class Adjoint(NamedTuple):
    """What the samples from one on tell of the parameters: r (p,) and N (p, p).

    ``product`` (p,) is scratch space for the product of N and a gain.
    """

    r: Array
    N: Array
    product: Array


@njit(cache=True)
def _step(phi: Array, y: float, theta: Array, P: Array, K: Array) -> tuple[float, float]:
    """Condition theta and P on one output; write the gain and return innovation and its variance.

    P[i, k] and P[k, i] are computed by the same operations in the same order, so that P stays
    exactly symmetric.
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
def run_filter(Phi: Array, y: Array, q: Array, theta_0: Array, P_0: Array, keep: bool) -> Filtered:
    """Run the filter forward from the mean (p,) and covariance (p, p) before the first sample.

    Without ``keep`` the predictions are not kept: a likelihood does not need them, and they are
    large.
    """
    n, p = Phi.shape
    rows = n if keep else 0
    predicted, covariance = np.empty((rows, p)), np.empty((rows, p, p))
    gain, innovation, S = np.empty((n, p)), np.empty(n), np.empty(n)
    theta, P = theta_0.copy(), P_0.copy()
    for t in range(n):
        for i in range(p):
            P[i, i] += q[i]
        if keep:
            for i in range(p):
                predicted[t, i] = theta[i]
                for k in range(p):
                    covariance[t, i, k] = P[i, k]
        innovation[t], S[t] = _step(Phi[t], y[t], theta, P, gain[t])
    return Filtered(gain, innovation, S, predicted, covariance)


@njit(cache=True)
def _none_yet(p: int) -> Adjoint:
    """Return the adjoint after the last sample."""
    return Adjoint(np.zeros(p), np.zeros((p, p)), np.empty(p))


@njit(cache=True)
def _adjoint_step(phi: Array, K: Array, innovation: float, S: float, adjoint: Adjoint) -> None:
    """Take r_t, N_t to r_{t-1}, N_{t-1}: r = phi v/S + L^T r, N = phi phi^T/S + L^T N L.

    L = I - K phi^T; K is zero and nothing changes where the output is missing.
    """
    if np.isnan(innovation):
        return
    r, N, NK = adjoint
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
def run_smoother(
    Phi: Array, filtered: Filtered, at: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """theta_{t|N} = theta_{t|t-1} + P r and P_{t|N} = P - P N P, P = P_{t|t-1}.

    Returns
    -------
    tuple
        Means (n, p), variances (n, p), and N (len(at), p, p) at the samples ``at``, which ascend:
        for the whole covariances there. Products of matrices take seconds to compile.
    """
    n, p = Phi.shape
    gain, innovation, S, predicted, P = filtered
    theta, variance = np.empty((n, p)), np.empty((n, p))
    kept = np.empty((at.size, p, p))
    adjoint = _none_yet(p)
    r, N, _ = adjoint
    wanted = at.size - 1
    for t in range(n - 1, -1, -1):
        _adjoint_step(Phi[t], gain[t], innovation[t], S[t], adjoint)
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
        # Instants before the largest lag all fall on the first sample.
        while wanted >= 0 and at[wanted] == t:
            for i in range(p):
                for k in range(p):
                    kept[wanted, i, k] = N[i, k]
            wanted -= 1
    return theta, variance, kept


@njit(cache=True)
def score(Phi: Array, filtered: Filtered, sigma2: float) -> Array:
    """d log L/dq_i = 1/2 sum_t (r_{t-1,i}^2/sigma^2 - N_{t-1,ii})."""
    n, p = Phi.shape
    gain, innovation, S, _, _ = filtered
    total, adjoint = np.zeros(p), _none_yet(p)
    r, N, _ = adjoint
    for t in range(n - 1, -1, -1):
        _adjoint_step(Phi[t], gain[t], innovation[t], S[t], adjoint)
        for i in range(p):
            total[i] += 0.5 * (r[i] * r[i] / sigma2 - N[i, i])
    return total
