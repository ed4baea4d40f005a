"""Feedback with margins over a band, and the loop closed around plants with known answers."""

from itertools import product

import numpy as np
import pytest
from scipy.signal import lfilter

import control
import dea
from dea.control import (
    Follower,
    Gains,
    OnlineTracker,
    RunIn,
    Task,
    inverse_input,
    linearise,
    tune_feedback,
)
from dea.control.adaptive_inverse import LostError
from dea.control.design import FromStart
from dea.errors import InputError
from dea.gfrf import ResponseBand
from dea.narx import NarxModel, Scaling, estimate, refine
from published_plants import published_plants

RATE = 50.0
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.5, y_scale=0.4)
PLANT = published_plants()["DEA2"]
PLANT = NarxModel(PLANT.terms, PLANT.parameters, SCALING)
FREQUENCIES = np.concatenate([np.geomspace(0.01, 2.0, 60), np.linspace(2.1, 24.9, 80)])
LOWEST, HIGHEST, SPEED = 1.6, 3.2, 20.0


def wide_band(model, share=0.1, degrees=5.0):
    """A band around the response of a model."""
    response = dea.frequency_response(model, 1, FREQUENCIES, RATE)
    gain, phase = np.abs(response), np.degrees(np.angle(response))
    return ResponseBand(
        response, gain / (1 + share), gain * (1 + share), phase - degrees, phase + degrees
    )


def least_distance(gains, response):
    return np.abs(1.0 + gains.response(FREQUENCIES) * response).min()


@pytest.mark.parametrize("largest", [1.2, 1.6, 2.0])
def test_every_response_in_the_band_keeps_the_margin_and_one_has_none_to_spare(largest):
    band = wide_band(PLANT)
    gains = tune_feedback(band, FREQUENCIES, RATE, integral_time=0.5, largest_sensitivity=largest)
    gain = np.linspace(band.gain_low, band.gain_high, 9)
    phase = np.radians(np.linspace(band.phase_low, band.phase_high, 9))
    brute = min(least_distance(gains, g * np.exp(1j * p)) for g, p in product(gain, phase))
    assert 1.0 / largest <= brute < 1.06 / largest


def test_the_loop_is_stable_with_the_sensitivity_that_python_control_finds():
    gains = tune_feedback(wide_band(PLANT), FREQUENCIES, RATE, integral_time=0.5)
    K, T = gains.proportional, 1 / RATE
    controller = control.tf([K * (1 + T / 0.5), -K], [1, -1], T)
    loop = controller * linearise(PLANT, sampling_rate=RATE).transfer_function()
    sensitivity = control.feedback(1, loop)
    z = np.exp(1j * np.linspace(1e-4, np.pi, 5000))
    assert 1.3 < np.abs(sensitivity(z)).max() <= 1.6
    _, phase_margin, *_ = control.margin(loop)
    assert phase_margin >= np.degrees(2 * np.arcsin(0.5 / 1.6))
    assert np.all(np.abs(control.feedback(loop).poles()) < 1.0)


def test_a_falling_response_gets_a_negative_gain():
    flipped = NarxModel(PLANT.terms, PLANT.parameters, SCALING)
    band = wide_band(flipped)
    band = band._replace(
        response=-band.response, phase_low=band.phase_low + 180, phase_high=band.phase_high + 180
    )
    rising = tune_feedback(wide_band(PLANT), FREQUENCIES, RATE, integral_time=0.5)
    falling = tune_feedback(band, FREQUENCIES, RATE, integral_time=0.5)
    assert falling.proportional == pytest.approx(-rising.proportional)


@pytest.mark.parametrize(
    ("change", "field"),
    [({"proportional": np.nan}, "proportional"), ({"integral_time": 0.0}, "integral_time"),
     ({"integral_time": np.nan}, "integral_time"), ({"integral_time": 1e-310}, "integral_time"),
     ({"filter_time": -0.02}, "filter_time"),
     ({"sampling_rate": -50.0}, "sampling_rate"), ({"sampling_rate": np.nan}, "sampling_rate"),
     ({"sampling_rate": 0.0}, "sampling_rate")],
)  # fmt: skip
def test_gains_out_of_range_are_refused(change, field):
    with pytest.raises(InputError) as refused:
        Gains(**{"proportional": 1.0, "integral_time": 0.5, "sampling_rate": RATE} | change)
    assert refused.value.field == field


@pytest.mark.parametrize(
    ("options", "field"),
    [({"integral_time": 0.0}, "integral_time"),
     ({"integral_time": 1.0, "filter_time": -0.02}, "filter_time"),
     ({"integral_time": 1.0, "filter_time": np.nan}, "filter_time"),
     ({"integral_time": 1.0, "largest_sensitivity": 1.0}, "largest_sensitivity")],
)  # fmt: skip
def test_settings_out_of_range_are_refused(options, field):
    with pytest.raises(InputError) as refused:
        tune_feedback(wide_band(PLANT), FREQUENCIES, RATE, **options)
    assert refused.value.field == field


@pytest.mark.parametrize("end", ["gain_low", "gain_high", "phase_low", "phase_high"])
def test_without_a_band_at_some_frequency_there_is_no_tuning(end):
    band = wide_band(PLANT)
    missing = np.where(np.arange(FREQUENCIES.size) == 50, np.nan, getattr(band, end))
    with pytest.raises(InputError, match="no band"):
        tune_feedback(band._replace(**{end: missing}), FREQUENCIES, RATE, integral_time=1.0)


@pytest.mark.parametrize(
    "chosen",
    [
        np.concatenate([[0.0], FREQUENCIES[1:]]),
        FREQUENCIES[::-1],
        np.concatenate([FREQUENCIES[:-1], [26.0]]),
        np.concatenate([FREQUENCIES[:-1], [np.nan]]),
        FREQUENCIES[:-1],
        FREQUENCIES[:, None],
    ],
    ids=["from 0 Hz", "falling", "above half the rate", "nan", "one too few", "column"],
)
def test_frequencies_that_are_not_those_of_a_loop_are_refused(chosen):
    with pytest.raises(InputError) as refused:
        tune_feedback(wide_band(PLANT), chosen, RATE, integral_time=0.5)
    assert refused.value.field == "frequencies"


@pytest.mark.parametrize(
    ("kept", "integral_time"), [(FREQUENCIES < 5.0, 0.5), (FREQUENCIES > 1.0, 1.0)]
)
def test_a_band_that_leaves_out_where_the_loop_may_be_unstable_is_refused(kept, integral_time):
    part = ResponseBand(*(each[kept] for each in wide_band(PLANT)))
    with pytest.raises(InputError) as refused:
        tune_feedback(part, FREQUENCIES[kept], RATE, integral_time=integral_time)
    assert refused.value.field == "frequencies"


@pytest.mark.parametrize(("gain", "problem"), [(0.0, "no sign"), (1.0, "no gain .* too large")])
def test_a_response_that_bounds_no_gain_is_refused(gain, problem):
    """PI control of a constant, without delay, is stable at every gain."""
    ends = np.full(FREQUENCIES.size, gain)
    level = np.zeros(FREQUENCIES.size)
    band = ResponseBand(ends.astype(complex), ends, ends, level, level)
    with pytest.raises(InputError, match=problem) as refused:
        tune_feedback(band, FREQUENCIES, RATE, integral_time=0.5)
    assert refused.value.field == "band"


@pytest.fixture(scope="module")
def identified():
    """A model of the plant from a noisy record, that record, and gains from its own band."""
    rng = np.random.default_rng(4)
    u = rng.uniform(LOWEST, HIGHEST, 4000)
    y = PLANT.simulate(u) + 1e-3 * rng.standard_normal(u.size)
    model = refine(estimate(PLANT.terms, u, y, scaling=SCALING), u, y)
    band = dea.frequency_response_band(model, 1, FREQUENCIES, RATE)
    return model, u, y, tune_feedback(band, FREQUENCIES, RATE, integral_time=0.5)


def closed_loop(plant, reference, follower, feedforward, disturbance=0.0, noise=0.0):
    """Inputs and outputs of the plant, sample by sample; ``feedforward(t)`` gives an input."""
    rng = np.random.default_rng(9)
    lag = plant.max_lag
    u, y = np.full(lag, follower.start), np.full(lag, PLANT.simulate(np.full(3000, 2.4))[-1])
    for t, wanted in enumerate(reference):
        past, known = np.append(u[-lag:], 0.0), np.append(y[-lag:], 0.0)
        now = plant.simulate(past, known[:lag])[lag]
        measured = now + (disturbance if t > 500 else 0.0) + noise * rng.standard_normal()
        u = np.append(u, follower.step(wanted, measured, feedforward(t, u, measured)))
        y = np.append(y, now)
    y[lag + 501 :] += disturbance
    return u[lag:], y[lag:]


def follower(gains, rate=SPEED):
    return Follower(gains, LOWEST, HIGHEST, rate, start=2.4)


def reachable(level):
    return float(PLANT.simulate(np.full(3000, level))[-1])


def test_a_step_disturbance_is_removed_without_an_error_that_stays(identified):
    *_, gains = identified
    reference = np.full(1500, reachable(2.5))
    _, y = closed_loop(PLANT, reference, follower(gains), lambda *_: 2.4, disturbance=0.02)
    assert abs(y[490] - reference[0]) < 1e-3
    assert y[501] - reference[0] > 0.019
    assert abs(y[-1] - reference[0]) < 1e-4


def test_neither_limit_is_passed_and_the_integral_does_not_wind_up(identified):
    *_, gains = identified
    out_of_reach, back = reachable(HIGHEST) + 0.2, reachable(2.4)
    reference = np.concatenate([np.full(1500, out_of_reach), np.full(500, back)])
    u, y = closed_loop(PLANT, reference, follower(gains, 5.0), lambda *_: 2.4)
    assert u.max() == HIGHEST
    assert u.min() >= LOWEST
    assert np.abs(np.diff(u)).max() <= 5.0 / RATE + 1e-12
    assert u[1560] < 2.8  # an integral of 30 s of error would hold the input at its limit
    assert abs(y[-1] - back) < 1e-3


def test_the_inverse_of_the_tracked_model_follows_better_than_feedback_alone(identified):
    model, u0, y0, gains = identified
    time = np.arange(1000) / RATE
    middle, stroke = 0.5 * (reachable(2.0) + reachable(2.8)), reachable(2.8) - reachable(2.0)
    reference = middle + 0.4 * stroke * np.sin(2 * np.pi * 0.5 * time)
    tracker = OnlineTracker.of_record(model, u0, y0)
    horizon = 3

    def inverse(t, u, measured):
        if t:
            tracker.update(u[-1], before[0])
        before[0] = measured
        if t < 10:
            return 2.4
        ahead = reference[min(t + horizon - 1, reference.size - 1)]
        return inverse_input(tracker.predict, ahead, horizon, LOWEST, HIGHEST, near=u[-1])

    before = [0.0]
    errors = {}
    for name, feedforward in {"alone": lambda *_: 2.4, "inverse": inverse}.items():
        _, y = closed_loop(PLANT, reference, follower(gains), feedforward, noise=1e-4)
        errors[name] = np.sqrt(np.mean((y - reference)[200:] ** 2)) / stroke
    assert errors["inverse"] < 0.3 * errors["alone"], errors


@pytest.mark.parametrize("filter_time", [0.0, 0.3])
def test_away_from_the_limits_the_follower_is_the_controller_that_was_tuned(filter_time):
    """Its answer to any error is the inverse transform of C(z)."""
    gains = Gains(0.2, 1.5, RATE, filter_time)
    error = np.random.default_rng(5).standard_normal(400)
    own = Follower(gains, -1e6, 1e6, 1e9, start=0.0)
    found = [own.step(each, 0.0, 0.0) for each in error]
    lag, step = filter_time * RATE, 1.0 / (RATE * gains.integral_time)
    numerator = 0.2 * np.array([1.0 + step, -1.0])
    expected = lfilter(numerator, np.convolve([1.0, -1.0], [1.0 + lag, -lag]), error)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_drive_begins_with_the_first_reading_after_the_hold():
    """Readings are lost from the end of the hold on."""
    run_in = RunIn(4, 5)
    task = Task(np.full(40, 1.0), 1.0, 2.4, run_in, (LOWEST, HIGHEST))
    own = FromStart(Follower(Gains(0.1, 1.0, RATE), LOWEST, HIGHEST, 1e3, start=2.4), task)
    inputs = [own(np.nan if 4 <= k < 7 else 0.5) for k in range(40)]
    assert inputs[:7] == [2.4] * 7
    assert np.isfinite(inputs).all()
    assert inputs[-1] > 2.4
    # The way of five samples begins there: of the steps 0, 1/5 ... 1 that of 2/5 is 0.31744.
    np.testing.assert_allclose(own.reference[6:10], [0.5, 0.5, 0.52896, 0.65872])
    np.testing.assert_array_equal(own.reference[12:], 1.0)


@pytest.mark.parametrize("begins", [0, 4, 20])
def test_a_follower_whose_sensor_is_silent_for_two_seconds_ends_its_drive(begins):
    task = Task(np.full(300, 1.0), 1.0, 2.4, RunIn(4, 5), (LOWEST, HIGHEST))
    own = FromStart(Follower(Gains(0.1, 1.0, RATE), LOWEST, HIGHEST, 1e3, start=2.4), task)
    for _ in range(begins):
        own(0.5)
    for _ in range(round(2.0 * RATE)):
        own(np.nan)
    with pytest.raises(LostError, match="no reading for 101 samples"):
        own(np.nan)


def test_a_sensor_that_drops_out_leaves_the_feedforward():
    held = Follower(Gains(1.0, 1.0, RATE), LOWEST, HIGHEST, 1e3, start=2.4)
    assert held.step(1.0, float("nan"), 2.5) == 2.5


def test_without_a_feedforward_the_last_one_is_kept_within_the_rate():
    """A change of 0.4 in a sample at most; without an error there is no feedback."""
    held = Follower(Gains(1.0, 0.5, RATE), 1.1, 3.75, rate=20.0, start=2.4)
    inputs = [held.step(0.0, 0.0, ahead) for ahead in (np.nan, 3.75, np.nan, 1.1, np.inf, 3.75)]
    assert inputs == pytest.approx([2.4, 2.8, 3.2, 2.8, 2.4, 2.8])


def test_no_reading_however_large_makes_an_input_that_is_no_number():
    held = Follower(Gains(1.0, 0.5, RATE), 1.1, 3.75, rate=20.0, start=2.4)
    inputs = [held.step(0.0, measured, 2.4) for measured in (-1.7e308, 1.7e308, 0.0, -1.7e308)]
    assert np.isfinite(inputs).all()
    assert np.abs(np.diff([2.4, *inputs])).max() <= 0.4 + 1e-12


@pytest.mark.parametrize(
    "options",
    [{"rate": 0.0}, {"start": 9.0}, {"highest": 1.0}, {"highest": np.inf}, {"lowest": -np.inf}],
)
def test_limits_that_contradict_are_refused(options):
    given = {"lowest": LOWEST, "highest": HIGHEST, "rate": SPEED, "start": 2.4} | options
    with pytest.raises(InputError, match="start"):
        Follower(Gains(1.0, 1.0, RATE), **given)


@pytest.mark.parametrize("horizon", [2, 3, 8])
def test_the_reference_of_the_inverse_is_that_of_the_last_sample_predicted(horizon):
    """The tracker knows the samples before t; u(t) is held for the samples of the horizon."""
    u = 2.4 + 0.5 * np.random.default_rng(3).uniform(-1, 1, 400).repeat(5)[:400]
    y = PLANT.simulate(u)
    tracker = OnlineTracker.of_record(PLANT, u, y, leakage=1e3)
    for each in zip(u, y, strict=True):
        tracker.update(*each)
    reference = np.linspace(reachable(2.3), reachable(2.5), 450)
    t = u.size
    wanted = reference[t + horizon - 1]
    held = inverse_input(tracker.predict, wanted, horizon, LOWEST, HIGHEST, near=u[-1])
    reached = PLANT.simulate(np.concatenate([u, np.full(horizon, held)]))
    assert LOWEST < held < HIGHEST
    assert reached[t + horizon - 1] == pytest.approx(wanted, abs=1e-6)


def test_the_inverse_is_exact_or_the_nearer_limit():
    past = PLANT.max_lag

    def predict(u):
        run = PLANT.simulate(np.concatenate([np.full(past, 2.4), u]), np.full(past, 0.5))
        return run[past:]

    for level in (1.9, 2.7):
        reached = predict(np.full(8, level))[-1]
        found = inverse_input(predict, reached, 8, LOWEST, HIGHEST, near=2.4)
        assert found == pytest.approx(level, abs=1e-6)
    assert inverse_input(predict, 1e3, 8, LOWEST, HIGHEST, near=2.4) == HIGHEST
    assert inverse_input(predict, -1e3, 8, LOWEST, HIGHEST, near=2.4) == LOWEST
    with pytest.raises(InputError, match="horizon"):
        inverse_input(predict, 0.5, 0, LOWEST, HIGHEST, near=2.4)
    with pytest.raises(InputError, match="finite limits"):
        inverse_input(predict, 0.5, 8, LOWEST, np.inf, near=2.4)
    for level in (np.nan, np.inf):
        with pytest.raises(InputError) as refused:
            inverse_input(predict, level, 8, LOWEST, HIGHEST, near=2.4)
        assert refused.value.field == "reference"


def test_of_several_inputs_it_is_the_one_nearest_to_the_last():
    def predict(u):
        return (u - 2.0) ** 2  # reaches 0.25 at 1.5 and at 2.5

    for near, expected in ((1.6, 1.5), (2.3, 2.5)):
        found = inverse_input(predict, 0.25, 3, 1.0, 4.0, near=near)
        assert found == pytest.approx(expected, abs=1e-6)


def test_an_input_that_diverges_is_not_taken():
    def predict(u):
        return np.where(u > 3.0, np.inf, u)

    assert inverse_input(predict, 2.2, 1, 1.0, 4.0, near=1.0) == pytest.approx(2.2)
    assert inverse_input(predict, 9.0, 1, 1.0, 4.0, near=1.0) <= 3.0
    # Nor is one whose prediction is no number.
    assert inverse_input(lambda u: np.where(u < 1.3, np.nan, u), 0.0, 1, 1.0, 4.0, 2.0) == 1.375
    assert inverse_input(lambda u: np.where(u > 3.0, np.nan, u), 9.0, 1, 1.0, 4.0, 2.0) == 2.875
    with pytest.raises(InputError, match="diverges at every input"):
        inverse_input(lambda u: np.full(u.size, np.inf), 0.0, 1, 1.0, 4.0, near=1.0)
