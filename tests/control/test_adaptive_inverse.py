"""The loop closed by the inverse of a tracked model, around plants with known answers."""

import numpy as np
import pytest

import dea
from dea.control import LostError, Trial
from dea.control.through_inverse import plan_response
from dea.control.trial import loop_frequencies, rests_of
from dea.gfrf import ResponseBand
from dea.narx import NarxModel, Scaling, estimate, refine
from dea.terms import Term

RATE = 50.0
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.5, y_scale=0.4)
TERMS = ("1", "y(t-1)", "y(t-2)", "u(t-1)", "u(t-2)", "u(t-1)^2")
PARAMETERS = np.array([0.0, 1.2, -0.3, 0.06, 0.02, 0.02])  # stable, and rises with its input
TRUTH = NarxModel(tuple(map(Term.parse, TERMS)), PARAMETERS, SCALING)
NOISE = 5e-4
SETTINGS = {
    "duration": 40.0, "hold": 1.0, "approach": 1.0, "rate": 40.0, "horizon": 12,
    "smoothness": 0.1, "integral_time": 0.1, "filter_time": 0.2, "largest_sensitivity": 1.6,
    "reference": {"shares": [0.2, 0.8], "turn": 10.0, "hold": 2.0, "rise": 0.6, "frequency": 0.5},
    "adaptation": {"forgetting": 0.998, "leakage": 3e-3, "delta": 30.0, "renewal": 20.0},
}  # fmt: skip


@pytest.fixture(scope="module")
def trial():
    rng = np.random.default_rng(4)
    coarse = np.interp(np.arange(6000), np.arange(0, 6000, 12), rng.uniform(1.6, 3.2, 500))
    y = TRUTH.simulate(coarse) + NOISE * rng.standard_normal(coarse.size)
    model = refine(estimate(TRUTH.terms, coarse, y, scaling=SCALING), coarse, y)
    return Trial.design(model, coarse, y, RATE, SETTINGS, 7)


@pytest.fixture(scope="module")
def gains(trial):
    return trial.gains()


class Plant:
    """The true model, whose gain may change, with a load, noise and a sensor that may drop."""

    def __init__(self, start, ageing=None, load=None, dropped=()):
        self.rng, self.sample = np.random.default_rng(2), 0
        self.u = [start] * 10
        self.y = [float(TRUTH.simulate(np.full(3000, start))[-1])] * 10
        self.ageing, self.load, self.dropped = ageing, load, dropped

    def measured(self):
        load = self.load(self.sample) if self.load else 0.0
        noisy = self.y[-1] + load + NOISE * self.rng.standard_normal()
        return np.nan if self.sample in self.dropped else noisy

    def __call__(self, u):
        self.u.append(u)
        share = 1.0 + (self.ageing(self.sample) if self.ageing else 0.0)
        (u1, u2), (y1, y2) = (
            (np.array(signal) - offset) / scale
            for signal, offset, scale in (
                (self.u[-2:-4:-1], SCALING.u_offset, SCALING.u_scale),
                (self.y[-1:-3:-1], SCALING.y_offset, SCALING.y_scale),
            )
        )
        now = PARAMETERS @ [1.0, y1, y2, share * u1, share * u2, share * u1**2]
        self.y.append(float(SCALING.restore_output(now)))
        self.sample += 1


def close(controller, plant, samples):
    outputs = []
    for _ in range(samples):
        plant(controller(plant.measured()))
        outputs.append(plant.y[-1])
    return np.array(plant.u[10:]), np.array(outputs)


def outputs(controller, measured):
    return [controller(each) for each in measured]


def error_of(trial, controller, y):
    lead = sum(trial.task.run_in)
    load_free = y - controller.reference[: y.size]
    return 100.0 * np.sqrt(np.mean(load_free[lead:] ** 2)) / trial.task.stroke


def test_the_plant_is_followed_to_a_per_cent_and_better_than_by_pi(trial, gains):
    samples = trial.task.reference.size
    adaptive, pi = trial.adaptive(gains), trial.follower(trial.proportional_integral())
    u, y = close(adaptive, Plant(trial.task.start), samples)
    low, high = trial.task.limits
    assert low <= u.min()
    assert u.max() <= high
    assert error_of(trial, adaptive, y) < 1.0
    _, by_pi = close(pi, Plant(trial.task.start), samples)
    assert error_of(trial, pi, by_pi) > 3.0 * error_of(trial, adaptive, y)


def test_a_step_disturbance_is_removed(trial, gains):
    load = 0.1 * trial.task.stroke
    plant = Plant(trial.task.start, load=lambda k: load if k > 600 else 0.0)
    controller = trial.fixed(gains)
    _, y = close(controller, plant, 1100)
    late = (y + load - controller.reference[:1100])[900:]
    assert np.sqrt(np.mean(late**2)) < 0.01 * trial.task.stroke


def test_a_sensor_that_drops_for_a_second_does_no_harm(trial, gains):
    plant = Plant(trial.task.start, dropped=range(700, 750))
    controller = trial.adaptive(gains)
    _, y = close(controller, plant, 1500)
    assert error_of(trial, controller, y) < 1.5


def test_a_silent_sensor_and_an_output_that_does_not_follow_end_the_drive(trial, gains):
    silent = Plant(trial.task.start, dropped=range(300, 10_000))
    with pytest.raises(LostError, match="no reading for 101 samples"):
        close(trial.adaptive(gains), silent, 1000)
    stuck = trial.fixed(gains)
    with pytest.raises(LostError, match="off by more than 50%"):
        outputs(stuck, [trial.task.reference[0]] * 60 + [5.0] * 500)


def test_tracked_parameters_in_doubt_give_way_to_the_model(trial, gains):
    jump = 0.5 * trial.task.stroke
    plant = Plant(trial.task.start, load=lambda k: jump if 600 < k < 604 else 0.0)
    controller = trial.adaptive(gains)
    _, y = close(controller, plant, 1000)
    assert controller.fallbacks == 1
    assert np.abs(y - controller.reference[:1000])[800:].max() < 0.05 * trial.task.stroke


def plain_band(response):
    gain, phase = np.abs(response), np.degrees(np.angle(response))
    return ResponseBand(response, gain, gain, phase, phase)


def test_the_response_of_the_plan_is_that_of_its_simulation(trial):
    """A small sine added to the reference: amplitude and angle of the inputs."""
    plan, (u, y) = trial.plan(), trial.rests[1]
    for frequency in (0.5, 3.0, 10.0):
        z = np.exp(2j * np.pi * np.array([frequency]) / RATE)
        response = dea.frequency_response(trial.model, 1, [frequency], RATE, operating_point=u)
        expected = plan_response(plan, u, y, plain_band(response), z)[0]
        count = 500
        v = 1e-5 * np.exp(2j * np.pi * frequency * np.arange(count) / RATE)
        inputs = []
        for part in (v.real, v.imag):
            plan.rest(u, y)
            still = plan.step(np.full(plan.horizon, y))
            plan.rest(u, y)
            found = []
            for each in part:
                found.append(plan.step(np.full(plan.horizon, y + each)) - still)
                plan.advance()
            inputs.append(np.array(found))
        last = (inputs[0] + 1j * inputs[1])[-1] / v[-1]
        assert last == pytest.approx(expected, rel=2e-3)


def test_the_tuned_loop_keeps_its_margin_at_every_rest_for_its_band(trial, gains):
    frequencies = loop_frequencies(RATE)
    z = np.exp(2j * np.pi * frequencies / RATE)
    least = []
    for u, y in trial.rests:
        band = dea.frequency_response_band(trial.model, 1, frequencies, RATE, operating_point=u)
        Q = plan_response(trial.plan(), u, y, band, z)
        for gain in np.linspace(band.gain_low, band.gain_high, 5):
            for phase in np.linspace(band.phase_low, band.phase_high, 5):
                H = gain * np.exp(1j * np.radians(phase))
                least.append(np.abs(1.0 + gains.response(frequencies) * Q * H / z).min())
    assert 1 / 1.6 <= min(least) < 1.06 / 1.6


def test_rests_are_those_of_the_simulation(trial):
    low, high = trial.rests[0][1], trial.rests[-1][1]
    wanted = np.array([low, 0.5 * (low + high), high])
    for u, y in rests_of(trial.model, (1.6, 3.2), wanted):
        assert trial.model.simulate(np.full(4000, u))[-1] == pytest.approx(y, abs=1e-6)
        assert np.abs(wanted - y).min() < 0.01 * (high - low)


def test_the_same_run_twice(trial, gains):
    runs = [close(trial.adaptive(gains), Plant(trial.task.start), 600)[0] for _ in range(2)]
    assert np.array_equal(*runs)
