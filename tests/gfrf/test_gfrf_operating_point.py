"""The zero-input response: which root, and when there is none."""

import numpy as np
import pytest

from dea.errors import InputError
from dea.gfrf import frequency_response, zero_input_response
from dea.narx import NarxModel, Scaling

# With y_t = y + slope (y + 0.1)(y - 1)(y - 3), y = y_{t-1}, the middle root attracts for a positive
# slope and the outer ones for a negative slope.
ROOTS = (-0.1, 1.0, 3.0)


def three_rests(slope: float) -> NarxModel:
    """A model whose static polynomial has the roots of ROOTS."""
    constant, first, second, third = np.polynomial.polynomial.polyfromroots(ROOTS) * slope
    return NarxModel.from_terms(
        {
            "1": constant,
            "y(t-1)": 1.0 + first,
            "y(t-1)^2": second,
            "y(t-1)^3": third,
            "u(t-1)": 0.1,
        }
    )


def test_the_root_is_the_one_the_simulation_settles_to():
    for slope in (0.2, -0.2):
        model = three_rests(slope)
        end = model.simulate(np.zeros(3000))[-1]
        assert zero_input_response(model) == pytest.approx(end, abs=1e-12)
        assert zero_input_response(model) == pytest.approx(1.0 if slope > 0 else -0.1, abs=1e-12)


def test_the_branch_is_followed_and_left_where_it_ends():
    """y - y^3 + c has three rests for |c| < 0.385; the lower one ends beyond."""
    model = NarxModel.from_terms({"1": 0.0, "y(t-1)": 1.2, "y(t-1)^3": -0.2, "u(t-1)": 1.0})
    c = np.concatenate([np.linspace(-0.06, 0.1, 81), np.linspace(0.1, -0.06, 81)])
    sets = np.tile(model.parameters, (c.size, 1))
    sets[:, 0] = c
    y0 = zero_input_response(model, parameters=sets)
    fold = 0.2 * 2.0 / 3.0**1.5
    lower, upper = c[:81] < fold - 1e-3, c[81:] > -fold + 1e-3
    assert np.all(y0[:81][lower] < -0.57)
    assert np.all(y0[:81][c[:81] > fold] > 1.0)
    assert np.all(y0[81:][upper] > 0.57)
    residual = sets[:, 0] + 0.2 * y0 - 0.2 * y0**3
    np.testing.assert_allclose(residual, 0.0, atol=1e-14)


@pytest.mark.parametrize(
    "terms",
    [
        {"1": 0.1, "y(t-1)": 1.1, "u(t-1)": 1.0},
        {"1": 0.1, "y(t-1)": 1.0, "u(t-1)": 1.0},
        {"1": 0.5, "y(t-1)": -1.2, "u(t-1)": 1.0, "y(t-1)^3": 0.05},
        {"1": 1.0, "y(t-1)": 1.0, "y(t-1)^2": 0.5, "u(t-1)": 1.0},
        {"1": 1.0, "y(t-1)": -1.0, "y(t-1)^2": 1.0, "u(t-1)": 1.0},
    ],
    ids=["unstable", "integrator", "oscillating", "no-real-root", "double-root"],
)
def test_a_model_that_does_not_settle_is_refused(terms):
    model = NarxModel.from_terms(terms)
    with pytest.raises(InputError, match="does not settle"):
        zero_input_response(model)
    with pytest.raises(InputError, match="does not settle"):
        frequency_response(model, 1, 1.0, 50.0)
    assert np.isnan(frequency_response(model, 1, 1.0, 50.0, allow_missing=True))


@pytest.mark.parametrize("level", [1e11, -1e30])
def test_a_linear_model_settles_at_any_level(level):
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.5})
    assert zero_input_response(model, operating_point=level) == pytest.approx(2.5 * level)
    response = frequency_response(model, 1, [0.0], 1.0, operating_point=level)
    np.testing.assert_allclose(response, 2.5)


def test_slow_models_settle_too():
    model = NarxModel.from_terms({"1": 1e-4, "y(t-1)": 0.9999, "u(t-1)": 1.0})
    assert zero_input_response(model) == pytest.approx(1.0, abs=1e-9)
    # At rest after 328,000 samples, within the last run alone.
    slower = NarxModel.from_terms({"1": 4e-5, "y(t-1)": 0.99996, "u(t-1)": 1.0})
    assert zero_input_response(slower) == pytest.approx(1.0, abs=1e-9)


def test_the_rest_is_in_physical_units_at_a_physical_input():
    scaling = Scaling(u_offset=2.0, u_scale=0.5, y_offset=10.0, y_scale=3.0)
    model = NarxModel.from_terms({"1": 0.1, "y(t-1)": 0.5, "u(t-1)": 0.25}, scaling=scaling)
    assert zero_input_response(model) == pytest.approx(10.0 + 3.0 * 0.2)
    assert zero_input_response(model, operating_point=2.5) == pytest.approx(10.0 + 3.0 * 0.7)
