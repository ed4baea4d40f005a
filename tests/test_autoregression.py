"""Autoregressive models of noise against simulated noise and dense matrices."""

import numpy as np
from scipy.signal import lfilter

from dea.autoregression import (
    Autoregression,
    fit_autoregression,
    innovations,
    noise_energy,
    whiten,
)


def test_an_autoregression_is_found_with_its_order_and_coefficients():
    rng = np.random.default_rng(0)
    noise = [lfilter([1.0], [1.0, -1.2, 0.5], 0.3 * rng.standard_normal(n)) for n in (4000, 6000)]
    found = fit_autoregression(noise)
    assert found.order == 2
    np.testing.assert_allclose(found.coefficients, [1.0, -1.2, 0.5], atol=0.03)
    np.testing.assert_allclose(found.variance, 0.09, rtol=0.05)
    assert fit_autoregression([rng.standard_normal(4000)]).order == 0


def test_a_short_segment_bounds_no_order_of_the_others():
    rng = np.random.default_rng(3)
    noise = lfilter([1.0], [1.0, -1.2, 0.5], rng.standard_normal(6000))
    for short in (2, 4):
        found = fit_autoregression([noise, noise[:short]])
        assert found.order == 2
        np.testing.assert_allclose(found.coefficients, [1.0, -1.2, 0.5], atol=0.03)
        np.testing.assert_allclose(found.variance, 1.0, rtol=0.05)


def test_where_every_second_sample_is_missing_no_order_is_known():
    noise = np.random.default_rng(4).standard_normal(600)
    noise[::2] = np.nan
    assert fit_autoregression([noise]).order == 0


def test_the_energy_of_a_signal_in_the_noise_is_that_of_the_dense_covariance():
    noise = Autoregression(np.array([1.0, -0.6, 0.2]), 0.5, 0.0)
    slope = np.random.default_rng(1).standard_normal((40, 3))
    whitening = np.column_stack([whiten(noise, row) for row in np.eye(40)])
    root = np.linalg.inv(whitening)
    dense = 0.5 * slope.T @ root @ root.T @ slope
    np.testing.assert_allclose(noise_energy(noise, slope), dense, rtol=1e-10)


def test_innovations_are_what_drove_the_noise():
    driving = np.random.default_rng(2).standard_normal(50)
    noise = lfilter([1.0], [1.0, -0.6, 0.2], driving)
    found = innovations(Autoregression(np.array([1.0, -0.6, 0.2]), 1.0, 0.0), noise)
    np.testing.assert_allclose(found, driving[2:])
