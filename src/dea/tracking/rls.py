"""Recursive least squares with forgetting and leakage, (11)-(16), in square-root form.

The recursion (12)-(16) carries P, which in floating point drifts away from symmetry until the
estimate diverges; a 30 min record is long enough for that. Here the triangular root U of the
information matrix is carried instead, U_n^T U_n = P_n^-1, and every new row enters by Givens
rotations. P is then symmetric and positive definite by construction, the leakage alpha I of (12)
costs no matrix inverse, and rounding grows with the condition number of the regressors and not
with its square, which matters because fast-sampled lags are nearly collinear.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.arrays import Array
from dea.narx import check_shape
from dea.tracking.setting_checks import check_settings


class RlsSettings(NamedTuple):
    """lambda, alpha and 1/P_0 of :func:`recursive_least_squares`."""

    forgetting: float
    leakage: float
    delta: float


class RlsTrack(NamedTuple):
    """What recursive least squares finds in n samples of p regressors, with these ``settings``.

    ``theta`` (n, p) are the estimates after each sample, ``variance`` (n, p) their variances,
    ``innovation`` (n,) the prediction errors before each update, and ``P`` (p, p) is P_n of (16)
    after the last sample.
    """

    theta: Array
    variance: Array
    innovation: Array
    P: Array
    settings: RlsSettings


class RlsState(NamedTuple):
    """What the recursion carries from sample to sample, of p regressors.

    ``U`` (p, p) and ``z`` (p,) are U_n b = z of b = theta - target, so that the leakage pulls b to
    zero; ``V`` (p, p) is the transposed inverse of U, ``theta`` (p,) the estimate, ``sums`` (2,)
    the least weighted sum of squares, with those of the pulls, and the weight of the samples;
    ``row`` (p,) is scratch space for a rotation.
    """

    U: Array
    z: Array
    V: Array
    theta: Array
    sums: Array
    row: Array


def recursive_least_squares(
    Phi: Array,
    y: Array,
    *,
    forgetting: float = 1.0,
    leakage: float = 0.0,
    delta: float = 1.0,
    theta_0: Array | None = None,
    target: Array | None = None,
) -> RlsTrack:
    """Minimise (11) at every sample, with exponential forgetting.

    The estimate after sample n minimises, exactly,

        sum_t lambda^(n-t) (|y_t - phi_t theta|^2 + alpha |theta - target|^2)
        + lambda^n delta |theta - theta_0|^2.

    With ``forgetting=1`` and ``target`` zero this is (11) as the paper prints it.

    Parameters
    ----------
    Phi, y
        Regressors (n, p) and outputs (n,). The equation of an output that is NaN is left out.
    forgetting
        lambda in (0, 1]; the memory is 1/(1 - lambda) samples.
    leakage
        alpha >= 0, the pull towards ``target`` in each sample.
    delta
        > 0; P_0 = I/delta.
    theta_0
        Estimate before the first sample; zero by default.
    target
        Where the leakage pulls to; ``theta_0`` by default.

    Returns
    -------
    RlsTrack
        The variances are sigma_n^2 P_n, with sigma_n^2 the least of the sum above over the weight
        of its samples: what the pulls add counts as residuals, as for a conjugate prior.

    Raises
    ------
    InputError
        If a setting is not a finite number, or outside its range; if a shape does not fit Phi's.
    """
    check_settings(forgetting, leakage, delta)
    Phi, y = np.ascontiguousarray(Phi, dtype=float), np.ascontiguousarray(y, dtype=float)
    samples, p = Phi.shape
    check_shape(y, (samples,), "y")
    theta_0 = np.zeros(p) if theta_0 is None else np.asarray(theta_0, dtype=float)
    target = theta_0 if target is None else np.asarray(target, dtype=float)
    for name, parameters in (("theta_0", theta_0), ("target", target)):
        check_shape(parameters, (p,), name)
    state = initial_state(theta_0, target, delta)
    found = _recursion(state, Phi, y, forgetting, leakage, target.copy())
    settings = RlsSettings(forgetting, leakage, delta)
    return RlsTrack(*found, state.V.T @ state.V, settings)


def recursion_covariance(
    Phi: Array,
    found: RlsTrack,
    at: NDArray[np.int64],
    *,
    target_covariance: Array,
    walk: Array,
) -> Array:
    """Return the covariance (k, p, p) of the estimates after the samples ``at``.

    sigma^2 P_n, which weighs old samples less, is not it. With white noise of variance sigma^2, an
    error of the target of covariance C_0 and parameters whose steps have the covariance W,

        P (sigma^2 sum_t lambda^(2(n-t)) phi_t phi_t^T + c^2 C_0 + sum_s A_s W A_s^T) P,
        A_s = sum_(t<s) lambda^(n-t) phi_t phi_t^T,

    where c is the weight of leakage and prior, and A_s w_s is what the samples before a step w_s
    keep the estimate back by.

    Parameters
    ----------
    Phi
        As given to :func:`recursive_least_squares`, whose result is ``found``.
    target_covariance
        C_0, shape (p, p).
    walk
        Variances of the steps of each parameter in one sample, shape (p,).
    """
    forgetting, leakage, delta = found.settings
    information, squares, behind = _weighted_squares(Phi, forgetting, walk, at)
    covariance = np.empty_like(information)
    for i, n in enumerate(at):
        fade = forgetting ** (n + 1.0)
        weight = n + 1.0 if forgetting == 1.0 else (1.0 - fade) / (1.0 - forgetting)
        pull = leakage * weight + delta * fade
        P = np.linalg.inv(information[i] + pull * np.eye(Phi.shape[1]))
        noise_variance = found.variance[n, 0] / P[0, 0]
        spread = noise_variance * squares[i] + pull**2 * target_covariance + behind[i]
        covariance[i] = P @ spread @ P
    return covariance


@njit(cache=True)
def _weighted_squares(
    Phi: Array, forgetting: float, walk: Array, at: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """Sum of phi phi^T with the weights lambda^(n-t), and with their squares, for each n of at.

    And that of A_s W A_s^T, with W of the diagonal ``walk``.
    """
    p = Phi.shape[1]
    once, twice, behind = np.zeros((p, p)), np.zeros((p, p)), np.zeros((p, p))
    first, second = np.empty((at.size, p, p)), np.empty((at.size, p, p))
    third = np.empty((at.size, p, p))
    fading = forgetting * forgetting
    wanted = 0
    for t in range(Phi.shape[0]):
        for i in range(p):
            for k in range(i + 1):
                step = 0.0
                for j in range(p):
                    step += once[i, j] * walk[j] * once[k, j]
                behind[i, k] = fading * (behind[i, k] + step)
                behind[k, i] = behind[i, k]
        for i in range(p):
            for k in range(p):
                product = Phi[t, i] * Phi[t, k]
                once[i, k] = forgetting * once[i, k] + product
                twice[i, k] = fading * twice[i, k] + product
        while wanted < at.size and at[wanted] == t:  # an instant may be asked for twice
            for i in range(p):
                for k in range(p):
                    first[wanted, i, k], second[wanted, i, k] = once[i, k], twice[i, k]
                    third[wanted, i, k] = behind[i, k]
            wanted += 1
    return first, second, third


def initial_state(theta_0: Array, target: Array, delta: float) -> RlsState:
    """Return the state before the first sample, its arrays new.

    Parameters
    ----------
    theta_0, target
        The first estimate, and what the leakage pulls to, shape (p,) each.
    delta
        As for :func:`recursive_least_squares`.
    """
    p = theta_0.size
    return RlsState(
        np.sqrt(delta) * np.eye(p),
        np.sqrt(delta) * (theta_0 - target),
        np.zeros((p, p)),
        theta_0.copy(),
        np.zeros(2),
        np.empty(p),
    )


@njit(cache=True, error_model="numpy")
def _rotate_in(U: Array, z: Array, row: Array, right: float) -> float:
    """Add the equation ``row @ b = right`` to ``U b = z``; return its residual's share."""
    p = z.size
    for i in range(p):
        if row[i] == 0.0:
            continue
        r = np.sqrt(U[i, i] * U[i, i] + row[i] * row[i])
        c, s = U[i, i] / r, row[i] / r
        U[i, i] = r
        for k in range(i + 1, p):
            upper = U[i, k]
            U[i, k] = c * upper + s * row[k]
            row[k] = c * row[k] - s * upper
        upper = z[i]
        z[i] = c * upper + s * right
        right = c * right - s * upper
    return right


@njit(cache=True, error_model="numpy")
def _invert_root(U: Array, V: Array) -> None:
    """Write the transposed inverse of the upper triangular ``U`` into ``V``."""
    p = U.shape[0]
    for i in range(p - 1, -1, -1):
        inverse = 1.0 / U[i, i]
        V[i, i] = inverse
        for j in range(i + 1, p):
            total = 0.0
            for k in range(i + 1, j + 1):
                total += U[i, k] * V[j, k]
            V[j, i] = -inverse * total


@njit(cache=True, error_model="numpy")
def update(
    state: RlsState, phi: Array, y: float, forgetting: float, leakage: float, target: Array
) -> float:
    """Pass one sample through the recursion, in place; return its prediction error.

    The equation of an output that is NaN is left out: its prediction error is NaN, too.

    Parameters
    ----------
    state
        Changed in place.
    phi, y
        Regressors (p,) and output of the sample.
    forgetting, leakage, target
        As for :func:`recursive_least_squares`; the target has the shape (p,).
    """
    U, z, V, theta, sums, row = state
    p = z.size
    fade, pull, known = np.sqrt(forgetting), np.sqrt(leakage), np.isfinite(y)
    innovation, right = y, y
    for i in range(p):
        innovation -= phi[i] * theta[i]
        right -= phi[i] * target[i]

    for i in range(p):
        z[i] *= fade
        for k in range(i, p):
            U[i, k] *= fade
    squares = forgetting * sums[0]
    if pull > 0.0:  # P*_n^-1 = P_{n-1}^-1 + alpha I, which (12), (13) write with P
        for i in range(p):
            row[:] = 0.0
            row[i] = pull
            squares += _rotate_in(U, z, row, 0.0) ** 2
    if known:
        for i in range(p):  # P_n^-1 = P*_n^-1 + phi phi^T: (14)-(16)
            row[i] = phi[i]
        squares += _rotate_in(U, z, row, right) ** 2
    sums[0], sums[1] = squares, forgetting * sums[1] + (1.0 if known else 0.0)

    _invert_root(U, V)  # P_n = V^T V
    for i in range(p):
        step = 0.0
        for k in range(i, p):
            step += V[k, i] * z[k]
        theta[i] = target[i] + step
    return innovation


@njit(cache=True, error_model="numpy")
def _recursion(
    state: RlsState, Phi: Array, y: Array, forgetting: float, leakage: float, target: Array
) -> tuple[Array, Array, Array]:
    n, p = Phi.shape
    thetas, variances, innovations = np.empty((n, p)), np.empty((n, p)), np.empty(n)
    V, theta, sums = state.V, state.theta, state.sums
    for t in range(n):
        innovations[t] = update(state, Phi[t], y[t], forgetting, leakage, target)
        for i in range(p):
            diagonal = 0.0
            for k in range(i, p):
                diagonal += V[k, i] * V[k, i]
            thetas[t, i] = theta[i]
            variances[t, i] = diagonal * sums[0] / sums[1]
    return thetas, variances, innovations
