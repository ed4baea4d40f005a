"""Covariances of smoothed parameters against dense linear algebra and drawn records."""

import numpy as np
import pytest

from dea.tracking.kalman import HIGHEST_RATIO, Prior, smooth
from dea.tracking.random_walk import RandomWalk
from dea.tracking.unknown_ratios import covariance_with_unknown_ratios, mean_common_ratio


def dense(Phi, y, q, prior_variance):
    """Return log-likelihood, means (n, p) and covariances (n, p, p) by one large Gaussian."""
    n, p = Phi.shape
    steps = np.minimum.outer(np.arange(1, n + 1), np.arange(1, n + 1))
    walk = prior_variance * np.ones((n, n))[:, :, None] + steps[:, :, None] * q
    rows = np.einsum("ti,sti,si->st", Phi, walk, Phi)
    total = np.eye(n) + rows
    sigma2 = float(y @ np.linalg.solve(total, y)) / n
    log_likelihood = -0.5 * (n * np.log(sigma2) + np.linalg.slogdet(total)[1])
    means, covariances = np.empty((n, p)), np.empty((n, p, p))
    for t in range(n):
        cross = walk[t] * Phi  # (n, p): covariance of the outputs with each parameter at t
        means[t] = cross.T @ np.linalg.solve(total, y)
        known = cross.T @ np.linalg.solve(total, cross)
        covariances[t] = sigma2 * (np.diag(walk[t, t]) - known)
    return log_likelihood, means, covariances


@pytest.mark.slow
def test_the_covariance_is_that_of_dense_algebra_over_a_fine_grid_of_ratios():
    rng = np.random.default_rng(3)
    n, at = 100, np.array([5, 30, 99])
    Phi = rng.standard_normal((n, 2))
    theta = np.cumsum(0.2 * rng.standard_normal((n, 2)), axis=0) * [1.0, 0.0]
    y = np.sum(Phi * theta, axis=1) + rng.standard_normal(n)
    q = np.array([0.003, 1e-4])
    prior = Prior(np.zeros(2), 1.0)
    found = smooth(Phi, y, q, prior, at)
    expected = dense(Phi, y, q, 1.0)[2][at]
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-8)
    fine = np.geomspace(1.0 / n**2, HIGHEST_RATIO, 100)
    extra = np.zeros_like(expected)
    for j in range(2):
        results = []
        for value in fine:
            ratios = q.copy()
            ratios[j] = value
            results.append(dense(Phi, y, ratios, 1.0))
        log_likelihood = np.array([result[0] for result in results])
        # Uniform in the standard deviation of the step.
        weight = np.exp(log_likelihood - log_likelihood.max()) * np.gradient(np.sqrt(fine))
        weight /= weight.sum()
        for w, (_, mean, covariance) in zip(weight, results, strict=True):
            moved = mean[at] - found.theta[at]
            extra += w * (covariance[at] - expected + np.einsum("ki,kj->kij", moved, moved))
    wider = covariance_with_unknown_ratios(Phi, y, found, prior, thinning=1, at=at)
    assert np.abs(extra).max() > 0.1 * np.abs(expected).max()
    np.testing.assert_allclose(wider - found.covariance, extra, atol=0.1 * np.abs(extra).max())


@pytest.mark.parametrize("step", [0.02, 0.03])
def test_intervals_hold_a_parameter_whose_walk_the_record_tells_little_of(step):
    rng = np.random.default_rng([7, round(1000 * step)])
    samples, at = 400, np.array([100, 200, 300])
    held, held_by_ratio = [], []
    for _ in range(150):
        Phi = rng.standard_normal((samples, 1))
        theta = np.cumsum(step * rng.standard_normal((samples, 1)), axis=0)
        y = np.sum(Phi * theta, axis=1) + rng.standard_normal(samples)
        walk = RandomWalk(thinning=1)
        found = walk.smooth(Phi, y, np.zeros(1), at)
        wider = walk.covariance(Phi, y, np.zeros(1), found, at)
        off = np.abs(found.theta - theta)[at, 0]
        held.append(off < 1.96 * np.sqrt(wider[:, 0, 0]))
        held_by_ratio.append(off < 1.96 * np.sqrt(found.covariance[:, 0, 0]))
    assert np.mean(held_by_ratio) < 0.92
    assert 0.92 < np.mean(held) < 0.98


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.0, 0.2])
def test_the_mean_of_a_common_ratio_is_that_over_a_fine_grid(step):
    rng = np.random.default_rng(4)
    n = 100
    Phi = rng.standard_normal((n, 2))
    theta = np.cumsum(step * rng.standard_normal((n, 2)), axis=0)
    y = np.sum(Phi * theta, axis=1) + rng.standard_normal(n)
    fine = np.geomspace(1.0 / n**2, HIGHEST_RATIO, 200)
    log_likelihood = np.array([dense(Phi, y, np.full(2, q), 1.0)[0] for q in fine])
    weight = np.exp(log_likelihood - log_likelihood.max()) * np.gradient(np.sqrt(fine))
    found = mean_common_ratio(Phi, y, Prior(np.zeros(2), 1.0), thinning=1)
    assert found == pytest.approx(weight @ fine / weight.sum(), rel=0.05)


def test_ratios_that_are_given_are_known():
    rng = np.random.default_rng(5)
    Phi, y, at = rng.standard_normal((50, 2)), rng.standard_normal(50), np.array([25])
    walk = RandomWalk(noise_ratio=np.array([1e-3, 1e-3]))
    found = walk.smooth(Phi, y, np.zeros(2), at)
    np.testing.assert_array_equal(walk.covariance(Phi, y, np.zeros(2), found, at), found.covariance)


def test_the_covariance_does_not_depend_on_the_units_of_a_regressor():
    rng = np.random.default_rng(6)
    Phi, at = rng.standard_normal((200, 2)), np.array([50, 150])
    y = Phi[:, 0] + np.cumsum(0.05 * rng.standard_normal(200)) * Phi[:, 1]
    y += rng.standard_normal(200)
    unit, walk = np.array([1.0, 1000.0]), RandomWalk(thinning=1)
    covariances = []
    for scale in (np.ones(2), unit):
        found = walk.smooth(Phi * scale, y, np.zeros(2), at)
        covariance = walk.covariance(Phi * scale, y, np.zeros(2), found, at)
        covariances.append(covariance * np.outer(scale, scale))
    np.testing.assert_allclose(covariances[1], covariances[0], rtol=1e-6)
