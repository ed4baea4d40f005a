"""Intervals of parameters and free runs."""

import numpy as np
import pytest

from dea.errors import InputError
from dea.narx import NarxModel, Scaling, parameter_interval, simulation_interval

SCALING = Scaling(u_offset=2.0, u_scale=1.5, y_offset=0.7, y_scale=0.4)
MODEL = NarxModel.from_terms({"y(t-1)": 0.7, "u(t-1)": 0.4, "y(t-1)u(t-1)^2": 0.2}, scaling=SCALING)
COVARIANCE = 1e-6 * np.array([[4.0, -1.0, 0.5], [-1.0, 2.0, 0.3], [0.5, 0.3, 1.0]])
KNOWN = MODEL.with_parameters(MODEL.parameters, COVARIANCE)


def test_an_interval_of_95_percent_reaches_1_96_standard_deviations():
    value, low, high = parameter_interval(KNOWN)
    reach = 1.959964 * np.sqrt([4e-6, 2e-6, 1e-6])
    np.testing.assert_allclose(value - low, reach, rtol=1e-6)
    np.testing.assert_allclose(high - value, reach, rtol=1e-6)
    narrow = parameter_interval(KNOWN, level=0.6826895)
    np.testing.assert_allclose(narrow.high - value, [2e-3, np.sqrt(2) * 1e-3, 1e-3], rtol=1e-6)


def test_the_band_of_a_free_run_is_the_spread_of_runs_with_drawn_parameters():
    rng = np.random.default_rng(0)
    u = rng.uniform(0.5, 3.5, 60)
    drawn = rng.multivariate_normal(MODEL.parameters, COVARIANCE, 3000)
    runs = np.array([MODEL.with_parameters(theta).simulate(u) for theta in drawn])
    run, low, high = simulation_interval(KNOWN, u)
    np.testing.assert_array_equal(run, MODEL.simulate(u))
    np.testing.assert_allclose((high - low)[2:] / (2 * 1.96), runs.std(axis=0)[2:], rtol=0.06)
    assert high[0] == low[0]


def test_the_band_of_a_run_from_rest_begins_where_the_input_acts():
    """y = theta u(t-1) + 0 u(t-4): the interval is that of theta times |u| from the second on."""
    model = NarxModel.from_terms({"u(t-1)": 0.5, "u(t-4)": 0.0})
    known = model.with_parameters(model.parameters, np.diag([4e-6, 0.0]))
    run, low, high = simulation_interval(known, np.array([1.0, -3.0, 2.0]))
    np.testing.assert_allclose(run, [0.0, 0.5, -1.5])
    np.testing.assert_allclose(high - low, 2 * 1.959964 * 2e-3 * np.array([0.0, 1.0, 3.0]))


def test_a_withheld_band_is_missing_and_a_model_without_covariance_is_refused():
    doubtful = MODEL.with_parameters(MODEL.parameters, COVARIANCE, "biased")
    assert np.isnan(parameter_interval(doubtful).low).all()
    with pytest.raises(InputError, match="covariance"):
        parameter_interval(MODEL)
    with pytest.raises(InputError, match="level"):
        parameter_interval(KNOWN, level=95.0)


def test_a_saved_model_keeps_why_its_band_is_withheld(tmp_path):
    doubtful = MODEL.with_parameters(MODEL.parameters, COVARIANCE, "biased")
    doubtful.save(tmp_path / "model.nc")
    assert NarxModel.load(tmp_path / "model.nc").withheld == "biased"
