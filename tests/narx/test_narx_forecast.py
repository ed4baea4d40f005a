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


def test_an_outage_as_long_as_the_window_ends_one_forecast_alone(record):
    model, u, y = record
    plan = ForecastPlan(**vars(PLAN) | {"window": 10.0})
    gone = y.copy()
    gone[460:600] = np.nan
    gone[800:810] = np.nan
    structures = {"narx": model, **baselines(model)}
    whole, gappy = (forecast_errors(structures, u, each, 10.0, plan) for each in (y, gone))
    error = gappy["error"]
    assert error.sel(origin=60.0).isnull().all()
    assert error.sel(origin=80.0, horizon=1.0).isnull().all()
    np.testing.assert_array_equal(error.sel(origin=40.0), whole["error"].sel(origin=40.0))
    np.testing.assert_allclose(
        gappy["rmse"].sel(horizon=5.0),
        np.sqrt((error.sel(horizon=5.0, origin=[40.0, 80.0]) ** 2).mean("origin")),
    )


def test_all_forecasters_are_compared_on_the_same_origins(record):
    """Before the second origin there are enough outputs for the smaller structure alone."""
    model, u, y = record
    large = NarxModel.from_terms(PLANT | {"y(t-60)": 0.0})
    gone = y.copy()
    gone[460:500] = np.nan
    gone[550:560] = np.nan
    alone = forecast_errors({"narx": model}, u, gone, 10.0, PLAN)["error"]
    assert alone.sel(origin=60.0).notnull().all()
    both = forecast_errors({"narx": model, "large": large}, u, gone, 10.0, PLAN)
    assert both["error"].sel(origin=60.0).isnull().all()
    left = both["error"].sel(origin=[40.0, 80.0])
    assert left.notnull().all()
    np.testing.assert_allclose(both["rmse"], np.sqrt((left**2).mean("origin")))


def test_a_horizon_without_outputs_after_any_origin_has_no_error(record):
    model, u, y = record
    plan = ForecastPlan(**vars(PLAN) | {"every": 100.0})
    gone = y.copy()
    gone[400:410] = np.nan
    rmse_of = forecast_errors({"narx": model}, u, gone, 10.0, plan)["rmse"]
    assert rmse_of.sel(horizon=1.0).isnull().all()
    assert rmse_of.sel(horizon=5.0).notnull().all()


def test_a_record_without_enough_outputs_before_any_origin_is_refused(record):
    model, u, y = record
    gone = np.where(np.arange(y.size) % 4 == 3, np.nan, y)
    with pytest.raises(InputError, match="y: no window of 30 s"):
        forecast_errors({"narx": model}, u, gone, 10.0, PLAN)
