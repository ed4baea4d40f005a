import numpy as np
import pytest

from dea import store
from dea.errors import InputError
from dea.narx import ForecastPlan, NarxModel, baselines, estimate, forecast_errors, refine
from dea.narx.metrics import rmse

PLANT = {"1": 0.2, "y(t-1)": 0.9, "u(t-1)": 0.1, "u(t-1)^2": 0.05, "y(t-1)u(t-1)": 0.05}
PLAN = ForecastPlan(start=40.0, every=20.0, window=30.0, horizons=[1.0, 5.0])


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(0)
    model = NarxModel.from_terms(PLANT)
    u = rng.standard_normal(1000)
    y = model.simulate(u) + 0.02 * np.sin(np.arange(1000) / 300) + 0.005 * rng.standard_normal(1000)
    return model, u, y


@pytest.fixture(scope="module")
def found(record):
    model, u, y = record
    return forecast_errors({"narx": model, **baselines(model)}, u, y, 10.0, PLAN, "mm")


def test_the_true_structure_beats_the_baselines_and_they_the_last_value(found):
    best = found["rmse"].sel(forecaster="narx")
    for other in ("linear", "hammerstein", "cubic", "last value"):
        assert (best < 0.7 * found["rmse"].sel(forecaster=other)).all(), other
    np.testing.assert_allclose(found["rmse"], np.sqrt((found["error"] ** 2).mean("origin")))
    np.testing.assert_array_equal(found["origin"], [40, 60, 80])


def test_a_forecast_uses_parameters_of_the_window_before_and_the_future_input(record, found):
    model, u, y = record
    past, ahead = slice(300, 600), slice(600, 650)
    first = refine(estimate(model.terms, u[past], y[past], scaling=model.scaling), u[past], y[past])
    run = first.simulate(u[599:650], y[599:600])[1:]
    expected = [rmse(y[ahead][:10], run[:10]), rmse(y[ahead], run)]
    # Two searches from different starts end at slightly different parameters.
    np.testing.assert_allclose(
        found["error"].sel(forecaster="narx", origin=60.0), expected, rtol=0.02
    )
    held = [rmse(y[ahead][:10], np.full(10, y[599])), rmse(y[ahead], np.full(50, y[599]))]
    np.testing.assert_allclose(found["error"].sel(forecaster="last value", origin=60.0), held)


def test_what_comes_later_changes_no_forecast(record, found):
    model, u, y = record
    later = y.copy()
    later[650:] += 10.0
    again = forecast_errors({"narx": model}, u, later, 10.0, PLAN)
    np.testing.assert_array_equal(
        again["error"].sel(forecaster="narx", origin=[40.0, 60.0]),
        found["error"].sel(forecaster="narx", origin=[40.0, 60.0]),
    )


def test_a_structure_without_a_constant_follows_the_level_too(record, found):
    model, u, y = record
    bare = NarxModel(model.terms[1:], model.parameters[1:], model.scaling)
    again = forecast_errors({"narx": bare}, u, y, 10.0, PLAN)
    np.testing.assert_allclose(
        again["rmse"].sel(forecaster="narx"), found["rmse"].sel(forecaster="narx"), rtol=1e-3
    )


def test_the_dataset_keeps_its_contract(found, tmp_path):
    store.write(found, tmp_path / "forecast.nc", title="Forecasts")
    assert store.read(tmp_path / "forecast.nc")["rmse"].attrs["units"] == "mm"


@pytest.mark.parametrize(
    "change",
    [{"start": 20.0}, {"start": 99.0}, {"horizons": [0.01]}, {"horizons": [5.0, 1.0]}],
)
def test_a_plan_that_does_not_fit_is_refused(record, change):
    model, u, y = record
    with pytest.raises(InputError, match="forecast"):
        forecast_errors({"narx": model}, u, y, 10.0, ForecastPlan(**{**vars(PLAN), **change}))


def test_a_forecast_knows_nothing_of_what_follows_its_origin(record):
    """Outputs are missing before it, and in another record the future lies far away."""
    model, u, y = record
    plan = ForecastPlan(start=60.0, every=100.0, window=50.0, horizons=(0.2,))
    gappy = y.copy()
    gappy[590:600] = np.nan
    later = gappy.copy()
    later[600:] += 5.0
    for measured in (gappy, later):
        found = forecast_errors({"narx": model}, u, measured, 10.0, plan)["error"]
        last = found.sel(forecaster="last value").item()
        assert last == pytest.approx(rmse(np.full(2, y[589]), measured[600:602]))
    assert found.sel(forecaster="narx").item() == pytest.approx(5.0, abs=0.6)
