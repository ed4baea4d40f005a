"""Tracking whole models: parameters that stand still, that drift, and noise on the output."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dea.errors import InputError
from dea.gfrf import frequency_response, frequency_response_band
from dea.narx import NarxModel, Scaling, estimate, refine, simulate_varying
from dea.store import Record
from dea.tracking import METHODS, compare_free_runs, track_parameters, with_constant
from dea.tracking.free_runs import _reach
from dea.tracking.sensitivity import sensitivity

RATE = 50.0
SAMPLES = 20_000
PLANT = NarxModel.from_terms(
    {
        "1": 0.0242,
        "y(t-1)": 1.2128,
        "y(t-2)": -0.3024,
        "u(t-1)": 0.1057,
        "u(t-2)": -0.0513,
        "y(t-1)u(t-1)^2": 0.05,
        "y(t-2)^2": -0.02,
    },
    scaling=Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.7, y_scale=0.4),
)
FREQUENCIES = np.array([0.1, 0.3, 0.6, 0.9])


def slow_input(seed: int) -> np.ndarray:
    """Noise up to 1 Hz between about -1 and 1: neighbouring samples are nearly collinear."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(SAMPLES))
    spectrum[np.fft.rfftfreq(SAMPLES, 1.0 / RATE) > 1.0] = 0.0
    noise = np.fft.irfft(spectrum, SAMPLES)
    return np.clip(noise / (3.0 * noise.std()), -1.0, 1.0)


def record(seed: int, noise: float, drift: float = 0.0):
    """Input, output and true parameters of PLANT, whose constant and u(t-1) drift."""
    u = slow_input(seed)
    theta = np.tile(PLANT.parameters, (SAMPLES, 1))
    ramp = np.linspace(0.0, 1.0, SAMPLES)
    theta[:, 0] += 0.03 * drift * ramp
    theta[:, 3] *= 1.0 + 0.2 * drift * ramp
    y = simulate_varying(PLANT.terms, theta, u, np.zeros(2))
    y += noise * y.std() * np.random.default_rng(seed + 1).standard_normal(SAMPLES)
    return (
        PLANT.scaling.u_offset + PLANT.scaling.u_scale * u,
        PLANT.scaling.restore_output(y),
        theta,
    )


def gain(theta: np.ndarray) -> np.ndarray:
    return np.abs(frequency_response(PLANT, 1, FREQUENCIES, RATE, parameters=theta))


@pytest.mark.parametrize("method", METHODS)
def test_constant_parameters_stay_constant(method):
    u, y, _ = record(1, noise=1e-3)
    track = track_parameters(PLANT, u, y, method=method, sampling_rate=RATE)
    tracked = gain(track["parameter"].values[2000::500])
    np.testing.assert_allclose(
        tracked, np.broadcast_to(gain(PLANT.parameters), tracked.shape), rtol=0.01
    )


@pytest.mark.parametrize(
    ("method", "share"), [("rls", 0.01), ("kalman", 1e-3), ("output_error", 1e-3), ("local", 0.01)]
)
def test_the_free_run_follows_a_drifting_plant(method, share):
    u, y, theta = record(2, noise=1e-3, drift=1.0)
    track = track_parameters(PLANT, u, y, method=method, sampling_rate=RATE)
    score = compare_free_runs(PLANT, {method: track}, u, y, window=1000)
    nmse = score["nmse"].to_series()
    assert nmse["fixed"] > 0.1
    assert nmse[method] < share * nmse["fixed"]
    assert score["nmse_frozen"].sel(simulation=method) < 0.05 * nmse["fixed"]
    np.testing.assert_allclose(
        gain(track["parameter"].values[3000:-1000:500]), gain(theta[3000:-1000:500]), rtol=0.08
    )


def test_tracking_the_free_run_is_not_biased_by_noise_on_the_output():
    u, y, theta = record(3, noise=0.03, drift=0.5)
    off = {}
    settings = {
        "rls": {"leakage": 0.0},
        "kalman": {"delta": 1.0},
        "output_error": {"delta": 1.0},
        "local": {"window": 2000},
    }
    for method, options in settings.items():
        track = track_parameters(PLANT, u, y, method=method, sampling_rate=RATE, **options)
        ratio = gain(track["parameter"].values[2000::500]) / gain(theta[2000::500])
        off[method] = np.abs(ratio.mean(axis=0) - 1.0).max()
    best = max(off["output_error"], off["local"])
    assert best < 0.01
    assert best < 0.25 * min(off["rls"], off["kalman"])


def test_sensitivity_is_the_derivative_of_the_free_run():
    u = slow_input(4)[:400]
    theta = np.tile(PLANT.parameters, (400, 1))
    theta[:, 0] += 0.01 * np.sin(np.arange(400) / 50.0)
    run = simulate_varying(PLANT.terms, theta, u, np.zeros(2))
    psi = sensitivity(PLANT.terms, theta, u, run)
    for j in range(theta.shape[1]):
        step = np.zeros(theta.shape[1])
        step[j] = 1e-6
        ahead, behind = (
            simulate_varying(PLANT.terms, theta + s * step, u, np.zeros(2)) for s in (1.0, -1.0)
        )
        np.testing.assert_allclose(psi[:, j], (ahead - behind)[2:] / 2e-6, rtol=1e-5, atol=1e-7)


def unequal_record():
    """A short record whose regressors differ in size by a factor of a thousand."""
    model = NarxModel.from_terms({"1": 0.3, "y(t-1)": 0.5, "u(t-1)": 0.02, "u(t-1)^2": -1e-4})
    rng = np.random.default_rng(12)
    u = rng.uniform(-50.0, 50.0, 60)
    y = model.simulate(u) + 0.05 * rng.standard_normal(60)
    Phi = np.column_stack([np.ones(59), y[:-1], u[:-1], u[:-1] ** 2])
    return model, u, y, Phi, np.sqrt(np.mean(Phi**2, axis=0))


def test_the_band_of_least_squares_is_that_of_the_batch_estimate():
    """The normal equations of (11) in the units of the model, where each weight has its own."""
    model, u, y, Phi, size = unequal_record()
    fade, leakage, delta = 0.95, 1e-3, 2.0
    track = track_parameters(model, u, y, forgetting=fade, leakage=leakage, delta=delta)
    for n in (5, 30, 59):
        weight = fade ** np.arange(n)[::-1]
        pull = np.diag(size**2) * (leakage * weight.sum() + delta * fade**n)
        information = Phi[:n].T @ (weight[:, None] * Phi[:n]) + pull
        right = Phi[:n].T @ (weight * y[1 : n + 1]) + pull @ model.parameters
        theta = np.linalg.solve(information, right)
        moved = theta - model.parameters
        squares = weight @ (y[1 : n + 1] - Phi[:n] @ theta) ** 2 + moved @ pull @ moved
        variance = squares / weight.sum() * np.diag(np.linalg.inv(information))
        np.testing.assert_allclose(track["parameter"].values[n], theta, rtol=1e-8)
        np.testing.assert_allclose(track["parameter_std"].values[n], np.sqrt(variance), rtol=1e-8)


@pytest.mark.usefixtures("never_withheld")
def test_instants_within_the_first_lags_have_the_covariance_of_the_first_estimate():
    model, u, y, *_ = unequal_record()
    model = replace(model, covariance=np.zeros((4, 4)))
    every = track_parameters(model, u, y)
    few = track_parameters(model, u, y, instants=7)
    covariance = every["covariance"].values
    assert np.isfinite(covariance).all()
    assert every.sizes["instant"] == u.size
    np.testing.assert_array_equal(covariance[0], covariance[1])
    at = np.searchsorted(every["instant"].values, few["instant"].values)
    np.testing.assert_allclose(covariance[at], few["covariance"].values, rtol=1e-12)


@pytest.fixture
def never_withheld(monkeypatch):
    """Covariances of records too short, or with too little noise, for intervals that hold."""
    monkeypatch.setattr("dea.tracking.track.reason_to_withhold", lambda *_: "")
    monkeypatch.setattr("dea.tracking.track.curvature_of_windows", lambda *_: 0.0)


@pytest.mark.usefixtures("never_withheld")
def test_the_band_of_the_smoother_is_that_of_the_joint_gaussian():
    """All parameters at all samples as one Gaussian vector, in the units of the model."""
    model, u, y, Phi, size = unequal_record()
    ratio, delta, (n, p) = 1e-3, 2.0, Phi.shape
    track = track_parameters(model, u, y, method="kalman", noise_ratio=ratio, delta=delta)
    # cov(theta_s, theta_t) of the walk, in units of the noise variance.
    steps = 1.0 + np.minimum.outer(np.arange(n), np.arange(n))
    prior = np.kron(1.0 / delta + ratio * steps, np.diag(1.0 / size**2))
    observe = np.zeros((n, n * p))
    for t in range(n):
        observe[t, t * p : (t + 1) * p] = Phi[t]
    marginal = observe @ prior @ observe.T + np.eye(n)
    residual = y[1:] - Phi @ model.parameters
    gain = prior @ observe.T @ np.linalg.inv(marginal)
    noise = residual @ np.linalg.solve(marginal, residual) / n
    variance = noise * np.diag(prior - gain @ observe @ prior).reshape(n, p)
    theta = model.parameters + (gain @ residual).reshape(n, p)
    np.testing.assert_allclose(track["parameter"].values[1:], theta, rtol=1e-6)
    np.testing.assert_allclose(track["parameter_std"].values[1:], np.sqrt(variance), rtol=1e-6)
    whole = noise * (prior - gain @ observe @ prior)
    for at, found in zip(track["instant"].values[1:], track["covariance"].values[1:], strict=True):
        t = p * (np.searchsorted(track["time"].values, at) - 1)
        expected = whole[t : t + p, t : t + p]
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9 * expected.max())
    # What was fitted stands for each term, what was given as an attribute.
    np.testing.assert_allclose(track["noise_ratio"], ratio)
    assert track.attrs["delta"] == delta
    assert "noise_ratio" not in track.attrs


def test_frozen_errors_are_those_of_each_stretchs_middle_parameters():
    model = NarxModel.from_terms({"1": 0.0, "y(t-1)": 0.5, "u(t-1)": 1.0})
    rng = np.random.default_rng(13)
    samples, window = 95, 20
    u = rng.standard_normal(samples)
    theta = model.parameters + np.linspace(0.0, 0.4, samples)[:, None] ** 2 * [1.0, 0.5, -1.0]
    y = np.cumsum(0.1 * rng.standard_normal(samples)) + u
    track = xr.Dataset({"parameter": (("time", "term"), theta)})
    errors = []
    for first in range(0, samples - window + 1, window):
        constant, pole, gain = theta[first + window // 2]
        run, squares = y[first], []
        for t in range(first + 1, first + window):
            run = constant + pole * run + gain * u[t - 1]
            squares.append((run - y[t]) ** 2)
        errors.append(np.mean(squares))
    found = compare_free_runs(model, {"made": track}, u, y, window=window)["nmse_frozen"]
    assert found.sel(simulation="made").item() == pytest.approx(np.median(errors) / np.var(y))


def test_errors_of_free_runs_are_in_the_outputs_unit_and_in_parts_of_its_variance():
    scaling = Scaling(y_scale=4.0, y_offset=10.0)
    model = NarxModel.from_terms({"1": 0.1, "u(t-1)": 0.5}, scaling=scaling)
    u, noise = np.random.default_rng(14).standard_normal((2, 500))
    y = model.simulate(u) + 0.3 * noise
    track = xr.Dataset({"parameter": (("time", "term"), np.tile(model.parameters, (u.size, 1)))})
    found = compare_free_runs(model, {"made": track}, u, y, window=100).sel(simulation="made")
    # The first sample is where the run begins.
    square = np.mean((y - model.simulate(u, y))[1:] ** 2)
    assert found["rmse"].item() == pytest.approx(np.sqrt(square), rel=0.01)
    assert found["nmse"].item() == pytest.approx(square / np.var(y), rel=0.01)


def test_the_track_is_labelled_and_complete():
    u, y, _ = record(5, noise=1e-3)
    track = track_parameters(PLANT, u, y, forgetting=0.999, sampling_rate=RATE)
    assert track["parameter"].dims == ("time", "term")
    assert track["term"].values.tolist() == [str(term) for term in PLANT.terms]
    assert track["time"].values[-1] == pytest.approx((SAMPLES - 1) / RATE)
    assert np.all(np.isfinite(track["parameter"]))
    assert np.all(track["parameter_std"] >= 0.0)
    missing = np.flatnonzero(np.isnan(track["innovation"].values))
    assert missing.tolist() == list(range(PLANT.max_lag))


def test_the_time_is_that_of_the_record_unless_a_rate_is_given():
    u, y, _ = record(5, noise=1e-3)
    measured = Record.of(u[:2001], y[:2001], 20.0)
    assert track_parameters(PLANT, measured)["time"].values[-1] == pytest.approx(100.0)
    given = track_parameters(PLANT, measured, sampling_rate=40.0)
    assert given["time"].values[-1] == pytest.approx(50.0)


def test_innovations_are_in_output_units():
    u, y, _ = record(6, noise=0.0)
    off = PLANT.with_parameters(PLANT.parameters + np.eye(7)[0] * 0.1)
    track = track_parameters(off, u, y)
    first = y - off.predict(u, y)
    assert track["innovation"].values[2] == pytest.approx(first[2], rel=1e-9)


def test_a_free_run_that_diverges_is_infinite_and_nothing_worse():
    u, y, _ = record(7, noise=0.0)
    unstable = PLANT.with_parameters(PLANT.parameters * np.array([1, 1.2, 1, 1, 1, 1, -20.0]))
    score = compare_free_runs(unstable, {}, u, y, window=1000)
    assert score["nmse"].item() == np.inf
    assert score["simulated"].values[0, -1] == np.inf


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"method": "guess"}, "method"),
        ({"forgetting": 1.5}, "forgetting"),
        ({"delta": -1.0}, "delta"),
        ({"method": "kalman", "thinning": 0}, "thinning"),
        ({"instants": 0}, "instants"),
        ({"method": "kalman", "forgetting": 0.99}, "forgetting"),
        ({"method": "output_error", "leakage": 0.0}, "leakage"),
        ({"thinning": 10}, "thinning"),
        ({"noise_ratio": 1e-6}, "noise_ratio"),
        *(
            ({"method": "kalman", "noise_ratio": ratio}, "noise_ratio")
            for ratio in (np.nan, np.inf, -1e-6, "a", [1e-6] * 6 + [np.nan])
        ),
        *(({"delta": delta}, "delta") for delta in (np.inf, np.nan, "a", [1.0, 2.0])),
        *(({"method": "kalman", "delta": delta}, "delta") for delta in (np.inf, "a")),
        *(({"leakage": leakage}, "leakage") for leakage in (np.inf, -1.0, "a")),
        *(({"forgetting": fade}, "forgetting") for fade in (np.nan, np.array([0.9]), "a")),
        *(({"instants": count}, "instants") for count in ("a", np.inf, np.nan, 1.5, 1j)),
        ({"method": "kalman", "thinning": "x"}, "thinning"),
        ({"method": "local", "window": "7"}, "window"),
        ({"u": np.ones(SAMPLES)}, "u"),
        ({"y": np.full(SAMPLES, np.nan)}, "y"),
    ],
)
def test_bad_requests_are_refused(change, field):
    u, y, _ = record(8, noise=1e-3)
    options = {"u": u, "y": y} | change
    with pytest.raises(InputError) as caught:
        track_parameters(PLANT, **options)
    assert caught.value.field == field


@pytest.mark.parametrize(
    "settings",
    [{"method": "kalman", "thinning": 20.0}, {"method": "local", "window": 100.0}],
)
def test_a_count_may_be_a_whole_float(settings):
    model, u, y, _, _ = unequal_record()
    track = track_parameters(model, u, y, instants=7.0, **settings)
    assert track.sizes["instant"] == 7
    assert track["parameter"].notnull().all()


def test_a_setting_of_another_method_names_the_methods_that_have_it():
    u, y, _ = record(8, noise=1e-3)
    with pytest.raises(InputError, match="method='kalman' or 'output_error'"):
        track_parameters(PLANT, u, y, method="rls", thinning=5)


def test_a_constant_is_tracked_where_the_model_has_none_and_carries_the_level():
    u, y, theta = record(9, noise=1e-3, drift=1.0)
    bare = NarxModel(PLANT.terms[1:], PLANT.parameters[1:], PLANT.scaling)
    track = track_parameters(bare, u, y, method="kalman", sampling_rate=RATE)
    assert track["term"].values.tolist() == [str(term) for term in PLANT.terms]
    np.testing.assert_allclose(
        gain(track["parameter"].values[3000:-1000:500]), gain(theta[3000:-1000:500]), rtol=0.08
    )
    assert with_constant(PLANT) is PLANT


def test_a_step_that_leads_nowhere_leaves_the_kalman_track():
    """A pole at 0.9999 remembers 10,000 samples, in which the parameters walk."""
    slow = NarxModel.from_terms({"1": 0.0, "y(t-1)": 0.9999, "u(t-1)": 0.05, "u(t-2)": -0.049})
    u = slow_input(10)
    rng = np.random.default_rng(11)
    theta = np.tile(slow.parameters, (SAMPLES, 1))
    theta[:, 0] += np.cumsum(2e-6 * rng.standard_normal(SAMPLES))
    y = simulate_varying(slow.terms, theta, u, np.zeros(2))
    y += 1e-3 * rng.standard_normal(SAMPLES)
    tracks = {m: track_parameters(slow, u, y, method=m) for m in ("kalman", "output_error")}
    nmse = compare_free_runs(slow, tracks, u, y, window=1000)["nmse"].to_series()
    assert nmse["output_error"] <= nmse["kalman"]


def delayed_gain():
    """A model whose parameter is given and not estimated, and a record with white noise."""
    model = NarxModel.from_terms({"u(t-1)": 0.5})
    u, noise = np.random.default_rng(6).standard_normal((2, 2000))
    return model, u, model.simulate(u) + 0.1 * noise


@pytest.mark.usefixtures("never_withheld")
def test_what_leakage_holds_is_as_uncertain_as_its_target():
    u, y, _ = record(5, noise=1e-3)
    deviation = 0.1 * (1.0 + np.abs(PLANT.parameters))
    known = replace(PLANT, covariance=np.diag(deviation**2))
    track = track_parameters(
        known, u[:4000], y[:4000], method="rls", leakage=1e4, sampling_rate=RATE
    )
    found = np.sqrt(np.diagonal(track["covariance"].values, axis1=1, axis2=2))
    np.testing.assert_allclose(found, np.broadcast_to(deviation, found.shape), rtol=1e-3)


def test_a_pull_to_parameters_of_unknown_covariance_withholds_the_band():
    model, u, y = delayed_gain()
    pulled, free = (
        track_parameters(model, u, y, method="rls", leakage=leakage) for leakage in (1e-3, 0.0)
    )
    assert "covariance is not known" in pulled.attrs["withheld"]
    assert not free.attrs["withheld"]


def test_bands_at_an_instant_of_a_withheld_track_are_missing():
    """Noise on the output biases a smoother of one-step errors."""
    plant = NarxModel.from_terms({"y(t-1)": 0.9, "u(t-1)": 1.0})
    rng = np.random.default_rng(1)
    u = rng.uniform(-1.0, 1.0, 3000)
    y = plant.simulate(u) + 0.3 * rng.standard_normal(3000)
    model = refine(estimate(plant.terms, u, y, scaling=Scaling()), u, y)
    track = track_parameters(model, u, y, method="kalman", sampling_rate=RATE)
    assert "correlated in time" in track.attrs["withheld"]
    at = track.sel(instant=30.0, method="nearest")
    band = frequency_response_band(
        with_constant(model),
        1,
        np.array([1.0, 5.0]),
        RATE,
        parameters=track["parameter"].sel(time=at["instant"]),
        covariance=at["covariance"],
    )
    assert np.isfinite(band.response).all()
    assert np.isnan([band.gain_low, band.gain_high, band.phase_low, band.phase_high]).all()


def test_the_interval_of_a_free_run_takes_the_covariance_of_its_part_of_the_record():
    """y = theta u(t-1): its deviation is that of theta times |u|."""
    model = NarxModel.from_terms({"u(t-1)": 0.5}, scaling=Scaling(y_scale=3.0))
    u = np.random.default_rng(5).standard_normal(400)
    theta = np.full((u.size, 1), 0.5)
    run = np.concatenate([[0.0], 0.5 * u[:-1]])
    reach = _reach(model, theta, u, run, np.array([[[1.0]], [[4.0]]]))
    expected = 1.959964 * 3.0 * np.repeat([1.0, 2.0], 200)[1:] * np.abs(u[:-1])
    np.testing.assert_allclose(reach[1:], expected, rtol=1e-6)
    assert reach[0] == 0.0
    run[-1] = np.inf
    assert np.isnan(_reach(model, theta, u, run, np.ones((1, 1, 1)))).all()


def test_a_free_run_has_an_interval_unless_that_of_its_track_is_withheld():
    model, u, y = delayed_gain()
    track = track_parameters(model, u, y, method="rls", leakage=0.0)
    assert not track.attrs["withheld"]
    withheld = track.assign_attrs(withheld="for a reason")
    found = compare_free_runs(model, {"given": track, "withheld": withheld}, u, y, window=500)
    within = (found["simulated_low"] <= found["simulated"]) & (
        found["simulated"] <= found["simulated_high"]
    )
    assert within.sel(simulation="given").all()
    assert found["simulated_low"].sel(simulation="withheld").isnull().all()


@pytest.mark.parametrize("method", METHODS)
def test_the_instant_nearest_to_a_time_is_one(method):
    """Of a short record some instants lie before the first equation."""
    u, y = record(3, 0.01)[:2]
    model = NarxModel.from_terms({"y(t-3)": 0.1, "u(t-1)": 0.5})
    track = track_parameters(model, u[:300], y[:300], method=method)
    assert track.indexes["instant"].is_unique
    assert track.sel(instant=0.4, method="nearest")["covariance"].shape[0] == track.sizes["term"]


def test_a_missing_sample_in_every_equation_is_named():
    u, y = record(3, 0.01)[:2]
    holes = np.where(np.arange(y.size) % 2, np.nan, y)
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.5})
    for method in METHODS:
        with pytest.raises(InputError, match="y: a missing sample enters every equation"):
            track_parameters(model, u, holes, method=method)


@pytest.mark.parametrize("method", METHODS)
def test_outputs_that_are_missing_at_the_start_leave_no_gap_in_the_bands(method):
    rng = np.random.default_rng(6)
    terms = {"y(t-1)": 0.8, "u(t-1)": 0.3}
    plant, u, y = NarxModel.from_terms(terms), rng.uniform(-1.0, 1.0, 3000), np.zeros(3000)
    for t in range(1, y.size):
        y[t] = 0.8 * y[t - 1] + 0.3 * u[t - 1] + 0.01 * rng.standard_normal()
    model = estimate(plant.terms, u, y, scaling=plant.scaling)
    y[:50] = np.nan
    track = track_parameters(model, u, y, method=method)
    assert not track.attrs["withheld"]
    for name in ("parameter_std", "covariance", "band_low", "band_high"):
        assert np.isfinite(track[name]).all(), name
    assert np.isnan(track["innovation"][:51]).all()
    assert np.isfinite(track["innovation"][51:]).all()
    runs = compare_free_runs(model, {method: track}, u, y, window=500)
    assert np.isfinite(runs["simulated_low"]).all()


def test_a_constant_leaves_a_model_its_trace_and_its_report():
    u, y = record(2, 0.01)[:2]
    plain = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.3})
    model = replace(plain, trace=xr.Dataset(), checked=PLANT.stability(u[:500], y[:500]))
    found = with_constant(model)
    assert found.parameters.tolist() == [0.0, 0.5, 0.3]
    assert (found.trace is model.trace, found.checked is model.checked) == (True, True)
