"""Tracking models with several inputs: a fixed plant, and a gain of one input that changes."""

import numpy as np
import pytest

import dea
from dea.narx import NarxModel, regressor_matrix
from dea.tracking import compare_free_runs

TERMS = {"1": 0.0, "y(t-1)": 0.7, "u1(t-1)": 0.5, "u2(t-2)": -0.3, "u1(t-1)u2(t-1)": 0.2}
MODEL = NarxModel.from_terms(TERMS)
RNG = np.random.default_rng(7)
U = RNG.uniform(-1.0, 1.0, (1500, 2))


def output(gain, noise=0.0):
    """The plant with this gain of the second input, (samples,)."""
    y = np.zeros(len(U))
    for t in range(2, len(U)):
        y[t] = 0.7 * y[t - 1] + 0.5 * U[t - 1, 0] + gain[t] * U[t - 2, 1]
        y[t] += 0.2 * U[t - 1, 0] * U[t - 1, 1]
    return y + noise * np.random.default_rng(1).standard_normal(len(U))


def test_recursive_least_squares_ends_at_the_batch_estimate_of_a_fixed_plant():
    y = output(np.full(len(U), -0.3), 0.01)
    track = dea.track_parameters(
        MODEL, U, y, method="rls", forgetting=1.0, leakage=0.0, delta=1e-12
    )
    Phi = regressor_matrix(MODEL.terms, U, y)
    batch = np.linalg.lstsq(Phi, y[MODEL.max_lag :], rcond=None)[0]
    np.testing.assert_allclose(track["parameter"][-1], batch, atol=1e-9)


@pytest.mark.parametrize("method", ["kalman", "output_error", "local"])
def test_smoothers_find_the_parameters_of_a_fixed_plant(method):
    y = output(np.full(len(U), -0.3), 0.002)
    track = dea.track_parameters(MODEL, U, y, method=method)
    error = track["parameter"].values - MODEL.parameters
    assert np.abs(error).max() < 0.01


@pytest.mark.parametrize("method", ["rls", "kalman"])
def test_a_changing_gain_is_found_in_the_input_that_it_is_of(method):
    gain = np.linspace(-0.3, -0.6, len(U))
    y = output(gain)
    settings = {"forgetting": 0.97} if method == "rls" else {}
    track = dea.track_parameters(MODEL, U, y, method=method, **settings)
    found = track["parameter"].sel(term="u2(t-2)").values[200:]
    np.testing.assert_allclose(found, gain[200:], atol=0.02)
    other = track["parameter"].sel(term="u1(t-1)").values[200:]
    np.testing.assert_allclose(other, 0.5, atol=0.02)
    runs = compare_free_runs(MODEL, {method: track}, U, y, window=100)
    assert float(runs["nmse"].sel(simulation=method)) < 1e-3
    assert float(runs["nmse"].sel(simulation="fixed")) > 1e-2
