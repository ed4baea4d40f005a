"""When the bands of a tracker of one-step errors are withheld."""

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.narx import NOT_WHITE, NarxModel, estimate
from dea.tracking import track_parameters
from dea.tracking.bands import reason_to_withhold

SAMPLES, WINDOW = 4000, 500


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def equations(rng, noise):
    """Regressors that vary slowly and the outputs of parameters that differ between windows."""
    Phi = np.column_stack([lfilter([1.0], [1.0, -0.9], rng.standard_normal(SAMPLES)) for _ in "ab"])
    theta = np.repeat(rng.standard_normal((SAMPLES // WINDOW, 2)), WINDOW, axis=0)
    return Phi, np.sum(Phi * theta, axis=1) + noise


def test_white_noise_beside_parameters_that_change_is_none(rng):
    noise = rng.standard_normal(SAMPLES)
    Phi, target = equations(rng, noise)
    assert reason_to_withhold(noise, Phi, target) == ""


def test_coloured_noise_is_seen_though_the_tracker_has_followed_it(rng):
    Phi, target = equations(rng, lfilter([1.0], [1.0, -0.6], rng.standard_normal(SAMPLES)))
    assert reason_to_withhold(rng.standard_normal(SAMPLES), Phi, target) == NOT_WHITE
    target[::7] = np.nan
    assert reason_to_withhold(rng.standard_normal(SAMPLES), Phi, target) == NOT_WHITE


def test_an_innovation_that_is_coloured_is_seen(rng):
    Phi, target = equations(rng, rng.standard_normal(SAMPLES))
    coloured = lfilter([1.0], [1.0, -0.6], rng.standard_normal(SAMPLES))
    assert reason_to_withhold(coloured, Phi, target) == NOT_WHITE


def test_without_outputs_the_innovation_alone_tells(rng):
    Phi = np.ones((40, 2))
    assert reason_to_withhold(rng.standard_normal(40), Phi, np.full(40, np.nan)) == ""


@pytest.mark.parametrize("method", ["rls", "kalman"])
def test_rounding_is_no_error_that_is_coloured(method):
    plant = NarxModel.from_terms({"1": 0.1, "y(t-1)": 1.6, "y(t-2)": -0.65, "u(t-1)": 0.05})
    u = np.cumsum(np.random.default_rng(2).uniform(-1.0, 1.0, SAMPLES))
    y = plant.simulate(u)
    model = estimate(plant.terms, u, y)
    assert track_parameters(model, u, y, method=method).attrs["withheld"] == ""
