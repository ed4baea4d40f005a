import numpy as np
import pytest

from dea import store
from dea.errors import InputError
from dea.narx import NarxModel, Windows, estimate, linear_terms
from dea.narx.estimation import normalised
from dea.narx.refinement import minimise
from dea.narx.validation import validate

PLANT = {"1": 0.2, "y(t-1)": 0.8, "u(t-1)": 0.3, "u(t-1)^2": 0.2}
WINDOWS = [(30.0, 45.0), (80.0, 95.0)]


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(0)
    model = NarxModel.from_terms(PLANT)
    u = rng.standard_normal(1000)
    return model, u, model.simulate(u) + 0.02 * rng.standard_normal(1000)


@pytest.fixture(scope="module")
def found(record):
    model, u, y = record
    models = {"linear": NarxModel(linear_terms(1, 1), np.zeros(3)), "narx": model}
    return validate(models, u, y, 10.0, Windows(WINDOWS, 30.0, 20), ("V", "mm"))


def test_scores_are_those_of_the_run_that_is_stored(found):
    error = found.measured - found.simulated
    rest = error.isel(sample=slice(1, None))
    measured = found.measured.isel(sample=slice(1, None))
    for name, values in (
        ("rmse", np.sqrt((rest**2).mean("sample"))),
        ("nmse", (rest**2).mean("sample") / measured.var("sample")),
    ):
        np.testing.assert_allclose(found[name], values.transpose(*found[name].dims), rtol=1e-9)
    np.testing.assert_allclose(found.fit, 1 - found.nmse)
    assert (found.nmse.sel(model="narx") < found.nmse.sel(model="linear")).all()


def free_run_fit(model, u, y):
    found = minimise(model.terms, model.parameters, normalised([(u, y)], model.scaling))
    return model.with_parameters(found.parameters)


def test_fitted_parameters_come_from_the_window_and_forecasts_from_before(record, found):
    model, u, y = record
    window, past = slice(800, 950), slice(500, 800)
    own = estimate(model.terms, u[window], y[window], scaling=model.scaling)
    earlier = estimate(model.terms, u[past], y[past], scaling=model.scaling)
    for approach, fitted in (
        ("fitted, one-step", own),
        ("fitted", free_run_fit(own, u[window], y[window])),
        ("forecast, one-step", earlier),
        ("forecast", free_run_fit(earlier, u[past], y[past])),
    ):
        run = found.simulated.sel(model="narx", approach=approach).isel(window=1)
        np.testing.assert_array_equal(run, fitted.simulate(u[window], y[window]))


def test_the_right_structure_passes_the_residual_tests_and_the_linear_one_fails(found):
    outside = np.abs(found.correlation) > found.band
    forecast = outside.sel(approach="forecast").mean(("test", "lag", "window"))
    assert forecast.sel(model="narx") < 0.12
    assert outside.sel(model="linear", test="phi_u2e", lag=1).all()


def test_a_fit_to_the_window_by_the_same_criterion_is_no_worse_than_its_forecast(found):
    assert (found.nmse.sel(approach="fitted") <= found.nmse.sel(approach="forecast")).all()
    assert (found.nmse.sel(approach="fitted") <= found.nmse.sel(approach="fitted, one-step")).all()


def test_the_verdict_tells_the_right_structure_from_the_linear_one(found):
    said = {str(name): str(found.verdict.sel(model=name).values) for name in found.model.values}
    assert "past inputs explain nothing" in said["narx"]
    assert "the square of the input" in said["linear"]
    p = found.p_value.sel(approach="forecast")
    assert (p.sel(model="linear", test="phi_u2e") < 1e-6).all()
    assert p.sel(model="narx").min() > 0.05 / p.sel(model="narx").size / 10


def test_it_is_stored_as_its_contract_says(found, tmp_path):
    store.write(found, tmp_path / "validation.nc", title="Validation")
    back = store.read(tmp_path / "validation.nc")
    assert back.fpe.attrs["units"] == "mm^2"
    assert float(back.time[1, 0]) == 80.0


@pytest.mark.parametrize("windows", [[(10, 25)], [(90, 105)], [(30, 33)], [(30, 45), (50, 70)], []])
def test_windows_that_do_not_fit_are_refused(record, windows):
    model, u, y = record
    with pytest.raises(InputError, match="windows"):
        validate({"narx": model}, u, y, 10.0, Windows(windows, 30.0, 20))


def test_a_model_that_diverges_has_infinite_scores_and_no_nan(record):
    _, u, _ = record
    y = np.cumsum(u) + 0.01 * np.arange(1000) ** 1.5
    model = NarxModel.from_terms({"y(t-1)": 1.1, "y(t-1)^2": 0.1, "u(t-1)": 1.0})
    found = validate({"narx": model}, u, y, 10.0, Windows(WINDOWS, 30.0, 20))
    for name, values in found.data_vars.items():
        assert not values.isnull().any(), name


def test_windows_of_one_length_have_as_many_samples_at_any_rate(record):
    model, u, y = record
    # 9.7 Hz puts the windows' ends between samples, once above and once below the half.
    windows = Windows([(30.0, 45.0), (80.1, 95.1)], 30.0, 20)
    odd = validate({"narx": model}, u, y, 9.7, windows)
    assert odd.sizes["sample"] == round(15.0 * 9.7)
