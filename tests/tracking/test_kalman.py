"""Filter, smoother and likelihood against the dense joint Gaussian."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dea.errors import InputError
from dea.tracking import Prior, fit_noise_ratio, log_likelihood, smooth
from dea.tracking.random_walk import RandomWalk


def random_walk(seed, n, q, noise=0.5):
    rng = np.random.default_rng(seed)
    p = len(q)
    Phi = rng.standard_normal((n, p))
    theta = np.cumsum(noise * np.sqrt(q) * rng.standard_normal((n, p)), axis=0)
    return Phi, theta, np.sum(Phi * theta, axis=1) + noise * rng.standard_normal(n)


def dense_posterior(Phi, y, q, theta_0, prior):
    """Condition the joint Gaussian of all parameters on all outputs that are not missing."""
    n, p = Phi.shape
    steps = np.minimum.outer(np.arange(1, n + 1), np.arange(1, n + 1))
    C = np.einsum("st,ij->sitj", np.ones((n, n)), np.diag(prior * np.ones(p)))
    C = (C + np.einsum("st,ij->sitj", steps, np.diag(q))).reshape(n * p, n * p)
    H = np.zeros((n, n * p))
    for t in range(n):
        H[t, t * p : (t + 1) * p] = Phi[t]
    H, seen = H[np.isfinite(y)], y[np.isfinite(y)]
    mean = np.tile(theta_0, n)
    S = H @ C @ H.T + np.eye(seen.size)
    error = seen - H @ mean
    sigma2 = error @ np.linalg.solve(S, error) / seen.size
    gain = np.linalg.solve(S, H @ C).T
    value = -0.5 * (seen.size * np.log(sigma2) + np.linalg.slogdet(S)[1])
    whole = sigma2 * (C - gain @ H @ C)
    covariance = np.array([whole[t : t + p, t : t + p] for t in range(0, n * p, p)])
    return (mean + gain @ error).reshape(n, p), covariance, sigma2, value


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(2, 30),
    q=st.lists(st.sampled_from([0.0, 1e-6, 0.01, 1.0]), min_size=1, max_size=3),
    missing=st.booleans(),
)
def test_smoother_and_likelihood_are_those_of_the_joint_gaussian(seed, n, q, missing):
    Phi, _, y = random_walk(seed, n, q)
    if missing:
        y[n // 2] = np.nan
    prior = Prior(np.ones(len(q)), 2.0)
    mean, covariance, sigma2, value = dense_posterior(Phi, y, np.array(q), np.ones(len(q)), 2.0)
    at = np.unique([0, n // 3, n - 1])
    found = smooth(Phi, y, q, prior, at)
    np.testing.assert_allclose(found.theta, mean, rtol=1e-9, atol=1e-9)
    variance = np.diagonal(covariance, axis1=1, axis2=2)
    np.testing.assert_allclose(found.variance, variance, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(found.covariance, covariance[at], rtol=1e-8, atol=1e-12)
    assert found.noise_variance == pytest.approx(sigma2, rel=1e-9)
    assert log_likelihood(Phi, y, q, prior)[0] == pytest.approx(value, rel=1e-9, abs=1e-9)
    last, _, _, _ = dense_posterior(Phi, y, np.array(q), np.ones(len(q)), 2.0)
    np.testing.assert_allclose(found.filtered[-1], last[-1], rtol=1e-9, atol=1e-9)


def test_a_random_walk_is_the_same_in_all_units_of_its_regressors():
    Phi, _, y = random_walk(11, 200, [1e-3, 0.02])
    units, at = np.array([50.0, 0.02]), np.array([3, 150])
    one = RandomWalk(noise_ratio=np.array([1e-3, 0.02])).smooth(Phi, y, np.ones(2), at)
    other = RandomWalk(noise_ratio=np.array([1e-3, 0.02])).smooth(
        Phi * units, y, np.ones(2) / units, at
    )
    np.testing.assert_allclose(other.theta * units, one.theta)
    np.testing.assert_allclose(other.filtered * units, one.filtered)
    np.testing.assert_allclose(other.variance * units**2, one.variance)
    np.testing.assert_allclose(other.covariance * np.outer(units, units), one.covariance)


def test_the_gradient_of_the_likelihood_is_exact():
    q = np.array([1e-3, 0.02, 0.3])
    Phi, _, y = random_walk(7, 300, q)
    prior = Prior(np.zeros(3), 1.0)
    _, gradient = log_likelihood(Phi, y, q, prior)
    for i in range(3):
        step = np.zeros(3)
        step[i] = 1e-4 * q[i]
        ahead, behind = (log_likelihood(Phi, y, q + s * step, prior)[0] for s in (1, -1))
        assert gradient[i] == pytest.approx((ahead - behind) / (2 * step[i]), rel=1e-5)


def test_fitted_ratios_tell_the_walking_parameters_from_the_standing():
    q = np.array([0.0, 1e-5, 1e-3])
    Phi, theta, y = random_walk(8, 20_000, q)
    prior = Prior(np.zeros(3), 1.0)
    found = fit_noise_ratio(Phi, y, prior)
    assert found[0] < 0.1 * q[1]
    np.testing.assert_allclose(found[1:], q[1:], rtol=0.35)
    smoothed = smooth(Phi, y, found, prior)
    within = np.abs(smoothed.theta - theta)[:, 1:] < 1.96 * np.sqrt(smoothed.variance[:, 1:])
    assert within.mean() == pytest.approx(0.95, abs=0.03)


def test_thinning_keeps_the_ratio_per_sample():
    q = np.array([1e-4])
    Phi, _, y = random_walk(9, 50_000, q)
    prior = Prior(np.zeros(1), 1.0)
    every = fit_noise_ratio(Phi, y, prior)
    fifth = fit_noise_ratio(Phi, y, prior, thinning=5)
    np.testing.assert_allclose([every[0], fifth[0]], q[0], rtol=0.4)


@pytest.mark.parametrize("thinning", [1, 3])
@pytest.mark.parametrize(("truth", "bound"), [(1.0, 1e-2), (1e-8, 1e-4)])
def test_a_ratio_beyond_the_bounds_ends_at_the_nearer_one(truth, bound, thinning):
    Phi, _, y = random_walk(11, 3000, np.array([truth]))
    prior = Prior(np.zeros(1), 1.0)
    found = fit_noise_ratio(Phi, y, prior, thinning=thinning, bounds=(1e-4, 1e-2))
    assert found[0] == pytest.approx(bound, rel=1e-9)


def test_the_smoother_survives_thirty_minutes_of_collinear_regressors():
    rng = np.random.default_rng(10)
    u = np.convolve(rng.standard_normal(90_050), np.ones(40) / 40, "valid")[:90_003]
    Phi = np.column_stack([u[k : k + 90_000] for k in range(4)])
    y = Phi @ np.ones(4) + 0.01 * rng.standard_normal(90_000)
    found = smooth(Phi, y, np.full(4, 1e-6), Prior(np.zeros(4), 1e4))
    assert np.all(found.variance > 0.0)
    np.testing.assert_allclose(found.theta.sum(axis=1)[1000:], 4.0, atol=0.05)


@pytest.mark.parametrize(
    ("noise_ratio", "prior_variance"),
    [(-1e-9, 1.0), (1.0, -1e-9), (np.nan, 1.0), (np.inf, 1.0), (1.0, np.nan), (1.0, np.inf)],
)
def test_a_negative_or_unbounded_variance_is_refused(noise_ratio, prior_variance):
    prior = Prior(np.zeros(1), prior_variance)
    with pytest.raises(InputError, match="a variance is negative"):
        smooth(np.ones((3, 1)), np.ones(3), [noise_ratio], prior)


@pytest.mark.parametrize("field", ["noise_ratio", "prior_variance"])
def test_the_variance_that_is_refused_is_named(field):
    variances = {"noise_ratio": np.ones(1), "prior_variance": 1.0, field: np.full(1, -1.0)}
    prior = Prior(np.zeros(1), variances["prior_variance"])
    with pytest.raises(InputError, match=f"^{field}: .*Give finite variances"):
        smooth(np.ones((3, 1)), np.ones(3), variances["noise_ratio"], prior)


def test_a_sample_that_is_asked_for_twice_has_the_same_covariance_twice():
    rng = np.random.default_rng(8)
    Phi, y = rng.standard_normal((50, 2)), rng.standard_normal(50)
    asked = np.full(2, 1e-2), Prior(np.zeros(2), 1.0)
    once, twice = (
        smooth(Phi, y, *asked, np.array(at)).covariance for at in ([0, 7], [0, 0, 0, 7, 7])
    )
    np.testing.assert_array_equal(twice, once[[0, 0, 0, 1, 1]])


def test_outputs_that_are_missing_in_step_with_the_thinning_leave_the_others():
    Phi, _, y = random_walk(9, 20_000, np.array([1e-4]))
    prior = Prior(np.zeros(1), 1.0)
    gappy = y.copy()
    gappy[::10] = np.nan
    shifted, found = (
        fit_noise_ratio(*each, prior, thinning=10) for each in ((Phi[1:], y[1:]), (Phi, gappy))
    )
    np.testing.assert_array_equal(found, shifted)


def test_what_does_not_fit_the_regressors_is_refused():
    Phi, y, q = np.ones((9, 2)), np.ones(9), np.full(2, 1e-3)
    fits, short = Prior(np.zeros(2), 1.0), Prior(np.zeros(1), 1.0)
    for estimate in (smooth, log_likelihood):
        with pytest.raises(InputError, match=r"y: its shape is \(8,\)\. Use \(9,\)"):
            estimate(Phi, y[:-1], q, fits)
        with pytest.raises(InputError, match=r"prior_mean: its shape is \(1,\)\. Use \(2,\)"):
            estimate(Phi, y, q, short)
    with pytest.raises(InputError, match="y: its shape"):
        fit_noise_ratio(Phi, y[:-1], fits, thinning=2)
