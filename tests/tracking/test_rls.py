"""Recursive least squares against the batch solution and the paper's own recursion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dea.errors import InputError
from dea.tracking import recursive_least_squares
from dea.tracking.rls import recursion_covariance


def weighted_ridge(Phi, y, n, forgetting, leakage, delta, theta_0, target):
    """Minimiser of (11) with forgetting after n samples, by one dense least-squares solve."""
    p = Phi.shape[1]
    weight = forgetting ** np.arange(n - 1, -1, -1.0)
    pull = np.sqrt(leakage * weight.sum())
    prior = np.sqrt(delta * forgetting**n)
    rows = [np.sqrt(weight)[:, None] * Phi[:n], pull * np.eye(p), prior * np.eye(p)]
    right = [np.sqrt(weight) * y[:n], pull * target, prior * theta_0]
    return np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]


def paper_recursion(Phi, y, alpha, P, theta):
    """(12)-(16) as printed, with matrices."""
    identity = np.eye(theta.size)
    thetas = []
    for phi, output in zip(Phi, y, strict=True):
        K_star = alpha * P @ np.linalg.inv(identity + alpha * P)  # (12)
        P_star = P - K_star @ P  # (13)
        K = P_star @ phi / (1.0 + phi @ P_star @ phi)  # (14)
        shrunk = K_star @ theta
        theta = theta - shrunk + K * (phi @ shrunk) + K * (output - phi @ theta)  # (15)
        P = P_star - np.outer(K, phi) @ P_star  # (16)
        thetas.append(theta)
    return np.array(thetas), P


def problem(seed, n, p):
    rng = np.random.default_rng(seed)
    Phi = rng.standard_normal((n, p)) @ rng.standard_normal((p, p))
    return Phi, Phi @ rng.standard_normal(p) + 0.1 * rng.standard_normal(n), rng


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 300),
    forgetting=st.floats(0.9, 1.0),
    leakage=st.floats(0.0, 1.0),
    delta=st.floats(0.01, 10.0),
)
def test_every_estimate_is_the_batch_weighted_ridge(seed, n, forgetting, leakage, delta):
    Phi, y, rng = problem(seed, n, 4)
    theta_0, target = rng.standard_normal((2, 4))
    options = {"forgetting": forgetting, "leakage": leakage, "delta": delta}
    found = recursive_least_squares(Phi, y, theta_0=theta_0, target=target, **options)
    for at in {1, (n + 1) // 2, n}:
        batch = weighted_ridge(Phi, y, at, theta_0=theta_0, target=target, **options)
        np.testing.assert_allclose(found.theta[at - 1], batch, rtol=1e-10, atol=1e-10)


def test_without_forgetting_it_is_the_papers_recursion():
    Phi, y, rng = problem(1, 200, 5)
    theta_0 = rng.standard_normal(5)
    expected, P = paper_recursion(Phi, y, 0.01, np.eye(5) / 2.0, theta_0)
    found = recursive_least_squares(
        Phi, y, leakage=0.01, delta=2.0, theta_0=theta_0, target=np.zeros(5)
    )
    np.testing.assert_allclose(found.theta, expected, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(found.P, P, rtol=1e-9, atol=1e-15)


def test_thirty_minutes_stay_symmetric_and_exact_where_the_plain_recursion_diverges():
    n, p, forgetting = 90_000, 10, 0.999
    rng = np.random.default_rng(3)
    Phi = rng.standard_normal((n, p))
    truth = rng.standard_normal(p)
    y = Phi @ truth + 0.01 * rng.standard_normal(n)

    theta, P = np.zeros(p), np.eye(p)
    plain = np.empty((n, p))
    for t, (phi, output) in enumerate(zip(Phi, y, strict=True)):
        P_phi = P @ phi
        K = P_phi / (forgetting + phi @ P_phi)
        theta = theta + K * (output - phi @ theta)
        # (16), with P phi standing for phi^T P as well: what rounding leaves of P - P^T then
        # grows by 1/lambda in each step.
        P = (P - np.outer(K, P_phi)) / forgetting
        plain[t] = theta
    assert np.abs(P - P.T).max() > 0.1 * np.abs(P).max()

    found = recursive_least_squares(Phi, y, forgetting=forgetting)
    np.testing.assert_array_equal(found.P, found.P.T)
    assert np.linalg.eigvalsh(found.P).min() > 0.0
    off, plain_off = (np.abs(track[1000:] - truth).max() for track in (found.theta, plain))
    assert off < 0.005
    assert plain_off > 20.0 * off
    batch = weighted_ridge(
        Phi[-40_000:], y[-40_000:], 40_000, forgetting, 0.0, 1.0, np.zeros(p), np.zeros(p)
    )
    np.testing.assert_allclose(found.theta[-1], batch, rtol=1e-10, atol=1e-10)


def test_leakage_keeps_what_the_data_do_not_excite():
    """Two equal regressors: their difference is unseen, and stays where the leakage pulls it."""
    rng = np.random.default_rng(4)
    u = rng.standard_normal(20_000)
    Phi = np.column_stack([u, u])
    theta_0 = np.array([3.0, 1.0])
    options = {"forgetting": 0.99, "leakage": 1e-4, "theta_0": theta_0}
    found = recursive_least_squares(Phi, 2.0 * u, **options)
    np.testing.assert_allclose(found.theta[-1].sum(), 2.0, atol=1e-3)
    np.testing.assert_allclose(np.diff(found.theta[-1]), np.diff(theta_0), atol=1e-6)


def test_standard_deviations_say_how_far_the_estimates_are():
    rng = np.random.default_rng(5)
    errors = []
    for _ in range(200):
        Phi = rng.standard_normal((400, 3))
        y = Phi @ np.ones(3) + 0.5 * rng.standard_normal(400)
        found = recursive_least_squares(Phi, y, delta=1e-6)
        errors.append((found.theta[-1] - 1.0) / np.sqrt(found.variance[-1]))
    assert np.std(errors) == pytest.approx(1.0, abs=0.12)


@pytest.mark.parametrize("forgetting", [0.97, 1.0])
def test_the_covariance_is_that_of_a_linear_map_of_noise_and_target(forgetting):
    """The estimate is linear in outputs and target: its Jacobians by the batch solution."""
    Phi, y, rng = problem(6, 120, 3)
    options = {"forgetting": forgetting, "leakage": 0.02, "delta": 3.0}
    target = rng.standard_normal(3)
    root = rng.standard_normal((3, 3))
    of_target = root @ root.T
    found = recursive_least_squares(Phi, y, theta_0=target, **options)
    at = np.array([4, 60, 60, 119])
    covariance = recursion_covariance(Phi, found, at, target_covariance=of_target, walk=np.zeros(3))
    for n, each in zip(at + 1, covariance, strict=True):

        def solved(outputs, pulled, n=n):
            return weighted_ridge(Phi, outputs, n, theta_0=pulled, target=pulled, **options)

        theta = solved(y[:n], target)
        weight = forgetting ** np.arange(n)[::-1]
        pull = options["leakage"] * weight.sum() + options["delta"] * forgetting**n
        squares = weight @ (y[:n] - Phi[:n] @ theta) ** 2 + pull * np.sum((theta - target) ** 2)
        by_output = np.column_stack([solved(unit, np.zeros(3)) for unit in np.eye(n)])
        by_target = np.column_stack([solved(np.zeros(n), unit) for unit in np.eye(3)])
        expected = squares / weight.sum() * by_output @ by_output.T
        expected += by_target @ of_target @ by_target.T
        np.testing.assert_allclose(each, expected, rtol=1e-7, atol=1e-12)


def test_parameters_that_walk_are_as_far_off_as_the_covariance_says():
    """Without noise, a mean with forgetting lags behind a random walk of known steps."""
    rng = np.random.default_rng(7)
    n, walks, forgetting = 600, 2000, 0.98
    truth = np.cumsum(0.1 * rng.standard_normal((walks, n)), axis=1)
    weight = (1.0 - forgetting) * forgetting ** np.arange(n)[::-1]
    Phi, options = np.ones((n, 1)), {"forgetting": forgetting, "leakage": 0.0, "delta": 1e-9}
    found = recursive_least_squares(Phi, np.zeros(n), **options)
    covariance = recursion_covariance(
        Phi, found, np.array([n - 1]), target_covariance=np.zeros((1, 1)), walk=np.array([0.01])
    )
    assert covariance.item() == pytest.approx(np.var(truth @ weight - truth[:, -1]), rel=0.1)


@pytest.mark.parametrize("forgetting", [1.0, 0.95])
def test_parameters_that_walk_beside_others_are_off_by_all_of_their_steps(forgetting):
    """Without noise, the error is linear in the steps, each of which a dense solution follows.

    The regressors are nearly collinear, as lags of a slow signal are.
    """
    rng = np.random.default_rng(3)
    n, walk = 80, np.array([0.01, 0.04, 0.0])
    slow = np.convolve(rng.standard_normal(n + 30), np.hanning(20), mode="same")[:n]
    Phi = np.column_stack([slow, np.roll(slow, 1), rng.standard_normal(n)])
    options = {"forgetting": forgetting, "leakage": 0.0, "delta": 1e-9}
    found = recursive_least_squares(Phi, np.zeros(n), **options)
    covariance = recursion_covariance(
        Phi, found, np.array([n - 1]), target_covariance=np.zeros((3, 3)), walk=walk
    )
    root, expected = np.sqrt(forgetting ** np.arange(n - 1, -1, -1.0)), np.zeros((3, 3))
    for step in range(1, n):
        for j, variance in enumerate(walk):
            y = np.where(np.arange(n) >= step, Phi[:, j], 0.0)
            error = np.linalg.lstsq(root[:, None] * Phi, root * y, rcond=None)[0] - np.eye(3)[j]
            expected += variance * np.outer(error, error)
    np.testing.assert_allclose(covariance[0], expected, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(
    "setting",
    [
        {"forgetting": 0.0},
        {"leakage": -1.0},
        {"leakage": np.inf},
        {"leakage": "a"},
        {"delta": 0.0},
        {"delta": np.inf},
    ],
)
def test_settings_out_of_range_are_refused(setting):
    with pytest.raises(InputError) as caught:
        recursive_least_squares(np.ones((3, 1)), np.ones(3), **setting)
    assert caught.value.field in setting


@pytest.mark.parametrize("share", [0.2, 0.5])
@pytest.mark.parametrize("forgetting", [1.0, 0.995])
def test_an_equation_that_is_missing_is_left_out(share, forgetting):
    """Estimates and variances are those of the other equations alone, their ages kept."""
    Phi, y, rng = problem(5, 4000, 3)
    missing = rng.random(y.size) < share
    found = recursive_least_squares(Phi, np.where(missing, np.nan, y), forgetting=forgetting)
    assert np.array_equal(np.isnan(found.innovation), missing)
    weight = np.where(missing, 0.0, forgetting ** np.arange(y.size - 1, -1, -1.0))
    prior = np.sqrt(forgetting**y.size) * np.eye(3)
    rows = np.vstack([np.sqrt(weight)[:, None] * Phi, prior])
    right = np.concatenate([np.sqrt(weight) * y, np.zeros(3)])
    theta, squares = np.linalg.lstsq(rows, right, rcond=None)[:2]
    np.testing.assert_allclose(found.theta[-1], theta, rtol=1e-9)
    variance = squares[0] / weight.sum() * np.diag(np.linalg.inv(rows.T @ rows))
    np.testing.assert_allclose(found.variance[-1], variance, rtol=1e-9)


@pytest.mark.parametrize("wrong", ["y", "theta_0", "target"])
def test_what_does_not_fit_the_regressors_is_refused(wrong):
    given = {"y": np.ones(9), "theta_0": np.zeros(2), "target": np.zeros(2)}
    given[wrong] = given[wrong][:-1]
    with pytest.raises(InputError, match=rf"{wrong}: its shape is \({given[wrong].size},\)\. Use"):
        recursive_least_squares(np.ones((9, 2)), given.pop("y"), **given)
