"""Missing samples: what identification, tracking, validation and forecasts make of them.

The oracle is the estimate that the same equations give by least squares on the rows that are left.
"""

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.autoregression import fit_autoregression
from dea.errors import InputError
from dea.missing import filled, stretches
from dea.narx import (
    ForecastPlan,
    FreeRun,
    NarxModel,
    Windows,
    baselines,
    forecast_errors,
    noise_model,
    select_terms,
    validate,
)
from dea.terms import Term
from dea.tracking import compare_free_runs, track_parameters

RATE = 10.0
RNG = np.random.default_rng(3)
U = np.convolve(RNG.standard_normal(3000), np.ones(5) / 5, "same")
PARAMETERS = {"1": 0.1, "y(t-1)": 0.7, "u(t-1)": 0.3, "u(t-1)^2": 0.1}
TRUTH = NarxModel.from_terms(PARAMETERS)
Y = TRUTH.simulate(U, np.zeros(1)) + 1e-3 * RNG.standard_normal(U.size)
LOST = np.array([100, 101, 640, 1500, 2222])


def with_nothing_there():
    y = Y.copy()
    y[LOST] = np.nan
    return y


def with_nonsense():
    """What the missing samples would have spoilt, had they been taken."""
    y = Y.copy()
    y[LOST] = 50.0
    return y


def test_stretches_lie_between_the_missing_samples():
    seen = np.isfinite(with_nothing_there())
    found = stretches(seen, slice(95, 700), lag=2, terms=4)
    assert [(each.start, each.stop) for each in found] == [(102, 640), (641, 700)]
    with pytest.raises(InputError, match="samples 97 to 103 hold no 7 in a row"):
        stretches(seen, slice(97, 104), lag=2)
    with pytest.raises(InputError, match="200 to 205 are 6, of which lags and terms take 7"):
        stretches(seen, slice(200, 206), lag=2)


def test_the_values_between_are_interpolated_only_to_start_runs():
    y, seen = filled(np.array([1.0, np.nan, 3.0]))
    assert y.tolist() == [1.0, 2.0, 3.0]
    assert seen.tolist() == [True, False, True]


def test_selection_from_stretches_finds_the_same_model():
    parts = stretches(np.isfinite(with_nothing_there()), slice(0, 3000), 2)
    found = select_terms(
        [U[part] for part in parts], [Y[part] for part in parts], y_lags=2, u_lags=2, degree=2
    )
    whole = select_terms(U, Y, y_lags=2, u_lags=2, degree=2)
    assert set(found.terms) == set(whole.terms)


def test_the_smoother_skips_equations_of_missing_samples():
    """Constant parameters with a wide prior are least squares on the equations that are left."""
    kept = np.ones(U.size, bool)
    kept[LOST] = kept[LOST + 1] = False
    kept[0] = False
    at = np.flatnonzero(kept)
    Phi = np.column_stack([np.ones(at.size), Y[at - 1], U[at - 1], U[at - 1] ** 2])
    expected, *_ = np.linalg.lstsq(Phi, Y[at], rcond=None)
    track = track_parameters(
        TRUTH, U, with_nothing_there(), method="kalman", noise_ratio=0.0, delta=1e-9
    )
    terms = list(track["term"].values)
    order = [terms.index(str(Term.parse(text))) for text in PARAMETERS]
    np.testing.assert_allclose(track["parameter"].values[-1, order], expected, rtol=1e-5)
    assert np.isnan(track["innovation"].values[LOST]).all()
    assert np.isnan(track["innovation"].values[LOST + 1]).all()


@pytest.mark.parametrize("method", ["rls", "output_error"])
def test_the_other_trackers_are_not_led_astray(method):
    settings = {} if method == "rls" else {"noise_ratio": 0.0}
    whole, gappy = (
        track_parameters(TRUTH, U, y, method=method, **settings) for y in (Y, with_nothing_there())
    )
    last = [each["parameter"].values[-1] for each in (whole, gappy)]
    np.testing.assert_allclose(last[1], last[0], atol=2e-3)
    spoilt = track_parameters(TRUTH, U, with_nonsense(), method=method, **settings)
    assert np.abs(spoilt["parameter"].values - whole["parameter"].values).max() > 0.05
    free = compare_free_runs(TRUTH, {method: gappy}, U, with_nothing_there(), window=200)
    assert (free["nmse"].values < 1e-3).all()


def test_validation_and_forecasts_score_what_is_there():
    windows = Windows([(140.0, 180.0), (200.0, 240.0)], before=60.0, max_lag=10)
    known = {"narx": TRUTH}
    whole, gappy = (validate(known, U, y, RATE, windows) for y in (Y, with_nothing_there()))
    np.testing.assert_allclose(gappy["rmse"], whole["rmse"], rtol=0.1)
    assert np.isnan(gappy["measured"].values).sum() == 2
    plan = ForecastPlan(start=60.0, every=30.0, window=50.0, horizons=(1.0, 5.0))
    structures = {"narx": TRUTH, **baselines(TRUTH)}
    whole, gappy = (
        forecast_errors(structures, U, y, RATE, plan) for y in (Y, with_nothing_there())
    )
    np.testing.assert_allclose(
        gappy["rmse"].sel(forecaster="narx"), whole["rmse"].sel(forecaster="narx"), rtol=0.3
    )
    assert np.isfinite(gappy["rmse"].values).all()


@pytest.mark.parametrize("missing", [0.01, 0.1])
def test_the_noise_of_a_residual_with_gaps_is_that_without(missing):
    """20 records in the mean, against the coefficients and the variance that made them."""
    found = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        noise = lfilter([1.0], [1.0, -0.9], rng.standard_normal(6000))
        noise[rng.random(noise.size) < missing] = np.nan
        fitted = fit_autoregression([noise])
        found.append((fitted.coefficients[1], fitted.variance, fitted.order))
    first, variance, order = np.mean(found, axis=0)
    assert first == pytest.approx(-0.9, abs=0.01)
    assert variance == pytest.approx(1.0, abs=0.02)
    if missing == 0.01:
        assert order < 1.1


@pytest.mark.parametrize("missing", [0.0, 0.01, 0.1])
def test_noise_on_the_output_is_told_from_noise_in_the_equation_beside_gaps(missing):
    rng = np.random.default_rng(5)
    terms, theta = (Term((1,), ()), Term((), (1,))), np.array([0.8, 0.2])
    u = rng.standard_normal(6000)
    run = lfilter([0.0, 0.2], [1.0, -0.8], u)
    driven = 0.1 * rng.standard_normal(u.size)
    gone = rng.random(u.size) < missing
    # A linear model passes noise on as an autoregression of the output does, of a higher order.
    for noise, told in (([1.0, -0.9], True), ([1.0, -0.8], missing < 0.1)):
        error = np.where(gone, np.nan, lfilter([1.0], noise, driven))
        left = FreeRun(u, run, error, np.empty((0, 0)))
        (feedback,), found = noise_model(terms, theta, [left])
        if told:
            assert feedback.any() == (noise == [1.0, -0.8])
        assert found.variance == pytest.approx(0.01, rel=0.1)
