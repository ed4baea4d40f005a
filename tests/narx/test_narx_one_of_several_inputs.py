"""A second input that no term uses changes nothing: results are those of the first alone."""

import numpy as np
import pytest

import dea
from dea.narx import (
    ForecastPlan,
    NarxModel,
    Scaling,
    Windows,
    baselines,
    compare_orders,
    estimate_refined,
    forecast_errors,
    held_out_error,
    inclusion_frequency,
    select_common_terms,
    validate,
)
from dea.tracking import compare_free_runs

RATE = 10.0
ALONE = NarxModel.from_terms({"1": 0.1, "y(t-1)": 0.6, "u(t-1)": 0.5, "u(t-2)^2": 0.2})
BESIDE = NarxModel.from_terms(
    {"1": 0.1, "y(t-1)": 0.6, "u1(t-1)": 0.5, "u1(t-2)^2": 0.2},
    scaling=Scaling((0.0, 5.0), (1.0, 2.0)),
)


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(11)
    u = rng.uniform(-1.0, 1.0, (600, 2))
    return u, ALONE.simulate(u[:, 0]) + rng.normal(0.0, 0.01, len(u))


def equal(several, one, names):
    for name in names:
        np.testing.assert_array_equal(several[name].values, one[name].values)


def test_prediction_score_and_refinement(record):
    u, y = record
    for steps in (1, 5):
        np.testing.assert_array_equal(
            BESIDE.predict(u, y, steps=steps), ALONE.predict(u[:, 0], y, steps=steps)
        )
    assert BESIDE.score(u, y) == ALONE.score(u[:, 0], y)
    assert held_out_error(BESIDE, u, y) == held_out_error(ALONE, u[:, 0], y)
    refined = [
        estimate_refined(model.terms, v, y, scaling=model.scaling)
        for model, v in ((BESIDE, u), (ALONE, u[:, 0]))
    ]
    np.testing.assert_array_equal(refined[0].parameters, refined[1].parameters)
    np.testing.assert_array_equal(refined[0].covariance, refined[1].covariance)


def test_forecasts_and_validation(record):
    u, y = record
    plan = ForecastPlan(start=40.0, every=5.0, window=20.0, horizons=(1.0, 5.0))
    found = [
        forecast_errors({"narx": model}, v, y, RATE, plan)
        for model, v in ((BESIDE, u), (ALONE, u[:, 0]))
    ]
    equal(*found, ["error", "rmse"])
    windows = Windows([(30.0, 45.0), (45.0, 60.0)], 20.0, 10)
    several = validate({"narx": BESIDE}, u, y, RATE, windows, (("V", "%"), "mm"), ["left", "right"])
    one = validate({"narx": ALONE}, u[:, 0], y, RATE, windows, ("V", "mm"))
    equal(several, one, ["simulated", "nmse", "rmse", "fpe"])
    assert several["input"].dims == ("window", "sample", "signal")
    assert several["input"].attrs["units"] == "V, %"
    assert several.sizes["test"] == 10
    first = several["correlation"].sel(test="phi_eu, u1").values
    np.testing.assert_allclose(first, one["correlation"].sel(test="phi_eu").values, atol=1e-12)


@pytest.mark.parametrize("method", ["rls", "kalman", "local", "output_error"])
def test_tracking(record, method):
    u, y = record
    settings = {"window": 200} if method == "local" else {}
    found = []
    for model, v in ((BESIDE, u), (ALONE, u[:, 0])):
        track = dea.track_parameters(model, v, y, method=method, instants=10, **settings)
        runs = compare_free_runs(model, {method: track}, v, y, window=100)
        found.append(track.merge(runs))
    equal(*found, ["parameter", "covariance", "band_low", "nmse", "simulated"])


def test_simpler_structures_have_every_input():
    assert [str(term) for term in baselines(BESIDE)["cubic"].terms] == [
        "1", "u1(t-1)", "u1(t-1)^2", "u1(t-1)^3", "u2(t-1)", "u2(t-1)^2", "u2(t-1)^3",
    ]  # fmt: skip
    assert [str(term) for term in baselines(ALONE)["cubic"].terms] == [
        "1", "u(t-1)", "u(t-1)^2", "u(t-1)^3",
    ]  # fmt: skip


def test_selections_find_the_input_that_acts(record):
    u, y = record
    orders = compare_orders(u[:400], y[:400], u[400:], y[400:], dynamic=2, polynomial=2)
    assert orders["dynamic_terms"].values.tolist() == [4, 7]
    settings = {"y_lags": 1, "u_lags": 2, "degree": 2}
    common = select_common_terms([(u[:300], y[:300]), (u[300:], y[300:])], **settings)
    acting = [term for term in common[0].terms if term.u_lags]
    assert {number for term in acting for number in term.inputs} == {1}
    share = inclusion_frequency(
        acting, u, y, rng=np.random.default_rng(0), resamples=2, blocks=4, **settings
    )
    assert share.min() == 1.0
    even = dea.select_terms(u**2, y, even_in_input=True, y_lags=1, u_lags=1, degree=2)
    assert all(set(term.input_powers.values()) <= {2} for term in even.terms)
