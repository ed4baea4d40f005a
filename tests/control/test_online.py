"""The tracker that takes one sample at a time: against the batch and a dense ridge."""

import numpy as np
import pytest

import dea
from dea.control import OnlineTracker
from dea.errors import InputError
from dea.narx import NarxModel, Scaling, regressor_matrix
from dea.tracking import root_mean_square, with_constant
from published_plants import published_plants

SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=-0.2, y_scale=0.7)
PLANTS = {
    name: NarxModel(plant.terms, plant.parameters, SCALING)
    for name, plant in published_plants().items()
}


def record(model, samples=2000, seed=11, missing=()):
    rng = np.random.default_rng(seed)
    u = SCALING.restore_input(rng.uniform(-0.7, 0.7, samples))
    y = model.simulate(u) + 2e-3 * rng.standard_normal(samples)
    y[list(missing)] = np.nan
    return u, y


def fed(tracker, u, y):
    """Parameters and prediction errors after each sample."""
    errors, rows = [], []
    for sample in zip(u, y, strict=True):
        errors.append(tracker.update(*sample))
        rows.append(tracker.parameters)
    return np.array(rows), np.array(errors)


@pytest.mark.parametrize("settings", [{}, {"forgetting": 0.99, "leakage": 0.0, "delta": 0.1}])
@pytest.mark.parametrize("missing", [(), (400, 401, 1205)], ids=["whole", "with gaps"])
def test_it_is_the_batch_tracker(settings, missing):
    model = PLANTS["DEA1"]
    u, y = record(model, missing=missing)
    batch = dea.track_parameters(model, u, y, instants=2, **settings)
    tracker = OnlineTracker.of_record(model, u, y, **settings)
    rows, errors = fed(tracker, u, y)
    lag = model.max_lag
    np.testing.assert_allclose(rows[lag:], batch["parameter"][lag:], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(errors[lag:], batch["innovation"][lag:], rtol=1e-8, atol=1e-10)
    assert np.isnan(errors[:lag]).all()
    deviation = batch["parameter_std"].values[-1]
    np.testing.assert_allclose(tracker.standard_deviations, deviation, rtol=1e-8)


def test_it_minimises_the_weighted_squares_with_leakage():
    model = with_constant(PLANTS["DEA2"])
    u, y = record(model, 300)
    forgetting, leakage, delta = 0.98, 0.01, 0.5
    tracker = OnlineTracker.of_record(
        model, u, y, forgetting=forgetting, leakage=leakage, delta=delta
    )
    fed(tracker, u, y)
    outputs = SCALING.normalise_output(y)
    Phi = regressor_matrix(model.terms, SCALING.normalise_input(u), outputs)
    scale = root_mean_square(Phi)
    n, p = Phi.shape
    weight = forgetting ** np.arange(n - 1, -1, -1.0)
    pull = np.sqrt(leakage * weight.sum() + delta * forgetting**n)
    centre = model.parameters * scale
    A = np.vstack([np.sqrt(weight)[:, None] * Phi / scale, pull * np.eye(p)])
    b = np.concatenate([np.sqrt(weight) * outputs[model.max_lag :], pull * centre])
    expected = np.linalg.lstsq(A, b, rcond=None)[0] / scale
    np.testing.assert_allclose(tracker.parameters, expected, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("name", ["DEA2", "DEA6"])
def test_predictions_are_the_free_run_from_the_measured_past(name):
    u, y = record(PLANTS[name], 400)
    tracker = OnlineTracker.of_record(PLANTS[name], u, y)
    fed(tracker, u[:300], y[:300])
    lag = tracker.model.max_lag
    expected = tracker.model.simulate(u[300 - lag :], y[300 - lag : 300])[lag:]
    found = tracker.predict(u[300:])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)
    error = tracker.update(u[300], y[300])
    assert y[300] - error == pytest.approx(found[0], abs=1e-12)


def test_it_predicts_through_a_sensor_that_drops_out():
    plant = PLANTS["DEA2"]
    u, y = record(plant, 1200)
    y[1000:1050] = np.nan
    tracker = OnlineTracker.of_record(plant, u, y)
    fed(tracker, u[:1050], y[:1050])
    true = plant.simulate(u)
    np.testing.assert_allclose(tracker.predict(u[1050:1060]), true[1050:1060], atol=0.01)
    _, errors = fed(tracker, u[1050:], y[1050:])
    assert np.isnan(errors[:2]).all()
    assert np.isfinite(errors[tracker.model.max_lag :]).all()


def test_it_follows_parameters_that_change():
    terms = {"1": 0.0, "y(t-1)": 0.8, "u(t-1)": 0.4, "u(t-1)^2": 0.1}
    before = NarxModel.from_terms(terms)
    after = NarxModel.from_terms(terms | {"u(t-1)": 0.6})
    u = np.random.default_rng(2).uniform(-1, 1, 3000)
    y = before.simulate(u[:1000])
    y = np.concatenate([y, after.simulate(u[999:], y[999:])[1:]])
    tracker = OnlineTracker.of_record(before, u, y, forgetting=0.99, leakage=0.0)
    rows, _ = fed(tracker, u, y)
    np.testing.assert_allclose(rows[999], before.parameters, atol=1e-9)
    np.testing.assert_allclose(rows[-1], after.parameters, atol=1e-6)


def test_memory_does_not_grow():
    u, y = record(PLANTS["DEA3"], 60)
    tracker = OnlineTracker.of_record(PLANTS["DEA3"], u, y)
    arrays = [*tracker._state, tracker._past, *tracker._lags]
    fed(tracker, u, y)
    now = [*tracker._state, tracker._past, *tracker._lags]
    assert all(a is b for a, b in zip(arrays, now, strict=True))
    assert set(vars(tracker)) == {
        "_count", "_lag", "_lags", "_model", "_past", "_scale", "_scaling", "_settings", "_state",
        "_target",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"forgetting": 0.0}, "forgetting"),
        ({"leakage": -1.0}, "leakage"),
        ({"delta": 0.0}, "delta"),
        ({"scale": np.ones(3)}, "scale"),
        ({"scale": np.zeros(11)}, "scale"),
    ],
)
def test_settings_out_of_range_are_refused(options, field):
    with pytest.raises(InputError) as refused:
        OnlineTracker(PLANTS["DEA1"], **{"scale": np.ones(11)} | options)
    assert refused.value.field == field


@pytest.mark.parametrize("reading", [1e200, -1e200, 1e12])
def test_a_reading_in_which_every_model_has_diverged_is_none(reading):
    plant = PLANTS["DEA1"]
    u, y = record(plant, 300, missing=(100,))
    expected, _ = fed(OnlineTracker.of_record(plant, u, y), u, y)
    tracker = OnlineTracker.of_record(plant, u, y)
    y[100] = reading
    found, _ = fed(tracker, u, y)
    np.testing.assert_array_equal(found, expected)
    assert np.isfinite(found).all()


def test_samples_that_are_no_numbers_are_refused_and_not_taken():
    tracker = OnlineTracker(PLANTS["DEA1"], np.ones(11))
    for sample in [(np.nan, 0.0), (np.inf, 0.0), (0.0, np.inf), (1e200, 0.0)]:
        with pytest.raises(InputError, match="finite"):
            tracker.update(*sample)
    with pytest.raises(InputError, match="0 samples were taken"):
        tracker.predict([1.0])
