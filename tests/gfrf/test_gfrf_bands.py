"""Bands of frequency responses against finite differences and drawn parameters."""

import numpy as np
import pytest
from scipy.stats import norm

from dea.errors import InputError
from dea.gfrf import (
    frequency_response,
    frequency_response_band,
    zero_input_interval,
    zero_input_response,
)
from dea.gfrf.response import response_and_slope, rests, tones_of
from dea.narx import NarxModel, Scaling
from published_plants import published_plants

RATE = 50.0
F = np.array([0.1, 0.5, 1.0])
PLANTS = published_plants()
SCALED = NarxModel.from_terms(
    {"1": 0.05, "y(t-1)": 0.8, "u(t-1)": 0.15, "y(t-1)^2": 0.04, "y(t-1)u(t-2)^2": 0.06},
    scaling=Scaling(u_offset=2.0, u_scale=1.5, y_offset=0.7, y_scale=0.4),
)


def ways(values):
    return {1: values, 2: (values[:, None], values), 3: (values, values, values)}


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("model", [*PLANTS.values(), SCALED], ids=[*PLANTS, "scaled"])
def test_the_slope_of_a_response_is_its_finite_difference(model, order):
    options = {"operating_point": 0.3 * model.scaling.u_scale + model.scaling.u_offset}
    tones = tones_of(model, order, ways(F)[order], RATE)
    response, slope = response_and_slope(model, tones, rests(model, **options))
    expected = frequency_response(model, order, ways(F)[order], RATE, **options)
    np.testing.assert_allclose(response, expected, rtol=1e-14)
    for j in range(len(model.terms)):
        step = np.zeros(len(model.terms))
        step[j] = 1e-6
        up, down = (
            frequency_response(
                model, order, ways(F)[order], RATE, parameters=model.parameters + sign * step,
                **options,
            )
            for sign in (1.0, -1.0)
        )  # fmt: skip
        np.testing.assert_allclose(
            slope[j], (up - down) / 2e-6, rtol=1e-6, atol=1e-7 * np.abs(slope[j]).max()
        )


def drawn(count=2000):
    root = np.random.default_rng(1).standard_normal((5, 5)) * 1e-4
    covariance = root @ root.T
    theta = np.random.default_rng(2).multivariate_normal(SCALED.parameters, covariance, count)
    return SCALED.with_parameters(SCALED.parameters, covariance), theta


@pytest.mark.parametrize("order", [1, 2])
def test_bands_hold_95_percent_of_the_responses_of_drawn_parameters(order):
    model, theta = drawn()
    band = frequency_response_band(model, order, ways(F)[order], RATE)
    sets = frequency_response(model, order, ways(F)[order], RATE, parameters=theta)
    within = (band.gain_low <= np.abs(sets)) & (np.abs(sets) <= band.gain_high)
    turned = np.degrees(np.angle(sets / band.response))
    inside = (band.phase_low <= band.phase + turned) & (band.phase + turned <= band.phase_high)
    np.testing.assert_allclose(within.mean(axis=0), 0.95, atol=0.02)
    np.testing.assert_allclose(inside.mean(axis=0), 0.95, atol=0.02)


def test_the_interval_of_the_rest_holds_95_percent_of_those_of_drawn_parameters():
    model, theta = drawn()
    y0, low, high = zero_input_interval(model)
    np.testing.assert_allclose(y0, zero_input_response(SCALED))
    rests = zero_input_response(SCALED, parameters=theta)
    np.testing.assert_allclose(np.mean((low <= rests) & (rests <= high)), 0.95, atol=0.02)


def test_each_set_of_parameters_has_its_own_covariance():
    model, theta = drawn(2)
    each = np.stack([model.covariance, 4.0 * model.covariance])
    pair = frequency_response_band(SCALED, 1, F, RATE, parameters=theta, covariance=each)
    for i in range(2):
        alone = SCALED.with_parameters(theta[i], each[i])
        single = frequency_response_band(alone, 1, F, RATE)
        np.testing.assert_allclose(pair.gain_high[i], single.gain_high)
        np.testing.assert_allclose(pair.phase_low[i], single.phase_low)


@pytest.mark.parametrize("sets", [(), (4,), (2, 4)])
def test_the_interval_of_a_linear_rest_is_that_of_error_propagation(sets):
    """Of y0 = (c + b u0) / (1 - a), whose slopes by c, a and b are 1, y0 and u0 over 1 - a."""
    rng = np.random.default_rng(4)
    c, a, b = rng.uniform(0.1, 0.5, (3, *sets))
    root = 0.02 * rng.standard_normal((*sets, 3, 3))
    covariance = root @ np.swapaxes(root, -1, -2)
    theta = np.stack([c, a, b], axis=-1)
    own = dict(zip(("1", "y(t-1)", "u(t-1)"), theta.reshape(-1, 3)[0], strict=True))
    found = zero_input_interval(
        NarxModel.from_terms(own), level=0.9, parameters=theta if sets else None,
        covariance=covariance, operating_point=0.7,
    )  # fmt: skip
    y0 = (c + 0.7 * b) / (1.0 - a)
    slope = np.stack([np.ones(sets), y0, np.full(sets, 0.7)], axis=-1) / (1.0 - a)[..., None]
    reach = norm.ppf(0.95) * np.sqrt(np.einsum("...j,...jk,...k", slope, covariance, slope))
    np.testing.assert_allclose(found, [y0, y0 - reach, y0 + reach], rtol=1e-12)


def test_a_variance_that_rounding_leaves_below_zero_is_none():
    y0, low, high = zero_input_interval(SCALED, covariance=-1e-20 * np.eye(5))
    assert low == y0 == high


def test_a_withheld_band_is_missing_and_a_wrong_covariance_refused():
    model, theta = drawn(2)
    doubtful = SCALED.with_parameters(SCALED.parameters, model.covariance, "biased")
    band = frequency_response_band(doubtful, 1, F, RATE)
    assert np.isnan([band.gain_low, band.gain_high, band.phase_low, band.phase_high]).all()
    assert np.isfinite(band.gain).all()
    with pytest.raises(InputError, match="covariance"):
        frequency_response_band(SCALED, 1, F, RATE)
    with pytest.raises(InputError, match="covariance"):
        frequency_response_band(model, 1, F, RATE, parameters=theta)
    with pytest.raises(InputError, match="covariance"):
        frequency_response_band(model, 1, F, RATE, parameters=theta, covariance=np.eye(5))


def test_a_linear_model_has_no_second_response_and_no_slope():
    linear = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0})
    tones = tones_of(linear, 2, ways(F)[2], RATE)
    response, slope = response_and_slope(linear, tones, rests(linear))
    assert not response.any()
    assert not slope.any()
