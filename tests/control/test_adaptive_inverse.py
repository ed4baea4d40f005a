"""The loop closed by the inverse of a tracked model, around plants with known answers."""

from dataclasses import replace

import numpy as np
import pytest

import dea
from dea.control import ControllerDesign, Gains, LostError
from dea.control.design import loop_frequencies, rests_of
from dea.control.through_inverse import inverse_response
from dea.errors import InputError
from dea.gfrf import ResponseBand
from dea.narx import Labels, NarxModel, Scaling, estimate, refine
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


def design_for(truth):
    rng = np.random.default_rng(4)
    coarse = np.interp(np.arange(6000), np.arange(0, 6000, 12), rng.uniform(1.6, 3.2, 500))
    y = truth.simulate(coarse) + NOISE * rng.standard_normal(coarse.size)
    model = refine(estimate(truth.terms, coarse, y, scaling=SCALING), coarse, y)
    return ControllerDesign.of_record(model, coarse, y, RATE, SETTINGS, 7)


@pytest.fixture(scope="module")
def design():
    return design_for(TRUTH)


@pytest.fixture(scope="module")
def gains(design):
    return design.gains()


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


def error_of(design, controller, y):
    lead = sum(design.task.run_in)
    load_free = y - controller.reference[: y.size]
    return 100.0 * np.sqrt(np.mean(load_free[lead:] ** 2)) / design.task.stroke


def test_the_plant_is_followed_to_a_per_cent_and_better_than_by_pi(design, gains):
    samples = design.task.reference.size
    adaptive, pi = design.adaptive(gains), design.follower(design.proportional_integral())
    u, y = close(adaptive, Plant(design.task.start), samples)
    low, high = design.task.limits
    assert low <= u.min()
    assert u.max() <= high
    assert error_of(design, adaptive, y) < 1.0
    _, by_pi = close(pi, Plant(design.task.start), samples)
    assert error_of(design, pi, by_pi) > 3.0 * error_of(design, adaptive, y)


def test_a_step_disturbance_is_removed(design, gains):
    load = 0.1 * design.task.stroke
    plant = Plant(design.task.start, load=lambda k: load if k > 600 else 0.0)
    controller = design.fixed(gains)
    _, y = close(controller, plant, 1100)
    late = (y + load - controller.reference[:1100])[900:]
    assert np.sqrt(np.mean(late**2)) < 0.01 * design.task.stroke


def test_a_sensor_that_drops_for_a_second_does_no_harm(design, gains):
    plant = Plant(design.task.start, dropped=range(700, 750))
    controller = design.adaptive(gains)
    _, y = close(controller, plant, 1500)
    assert error_of(design, controller, y) < 1.5


def test_a_silent_sensor_and_an_output_that_does_not_follow_end_the_drive(design, gains):
    silent = Plant(design.task.start, dropped=range(300, 10_000))
    with pytest.raises(LostError, match="no reading for 101 samples"):
        close(design.adaptive(gains), silent, 1000)
    stuck = design.fixed(gains)
    with pytest.raises(LostError, match="off by more than 50%"):
        outputs(stuck, [design.task.reference[0]] * 60 + [5.0] * 500)


@pytest.mark.parametrize("missing", [0, 1, 40])
def test_a_sensor_that_is_silent_after_the_hold_delays_the_way_to_the_reference(
    design, gains, missing
):
    hold, approach = design.task.run_in
    plant = Plant(design.task.start, dropped=range(hold, hold + missing))
    controller = design.adaptive(gains)
    u, y = close(controller, plant, 1500)
    assert np.all(u[: hold + missing] == design.task.start)
    begun = controller.reference[hold + missing]
    assert begun == pytest.approx(plant.y[9], abs=5 * NOISE)
    arrived = slice(hold + missing + approach, None)
    np.testing.assert_array_equal(controller.reference[arrived], design.task.reference[arrived])
    assert error_of(design, controller, y) < 1.0


@pytest.mark.parametrize("rate", [20.0, 50.0, 125.0])
def test_two_seconds_are_two_seconds_at_any_rate(design, rate):
    controller = replace(design, sampling_rate=rate).fixed(Gains(0.5, 0.1, rate, 0.2))
    with pytest.raises(LostError, match=f"no reading for {round(2 * rate) + 1} samples"):
        outputs(controller, np.full(1000, np.nan))


def test_a_sensor_that_never_speaks_ends_the_drive(design, gains):
    with pytest.raises(LostError, match="no reading for 101 samples"):
        outputs(design.adaptive(gains), np.full(300, np.nan))


def test_a_reading_that_is_infinite_is_none(design, gains):
    runs = []
    for lost in (np.nan, np.inf, -np.inf):
        controller = design.adaptive(gains)
        wanted = design.task.reference
        runs.append(outputs(controller, [lost if k == 100 else wanted[k] for k in range(140)]))
    assert runs[1] == runs[0]
    assert runs[2] == runs[0]


def test_tracked_parameters_in_doubt_give_way_to_the_model(design, gains):
    jump = 0.5 * design.task.stroke
    plant = Plant(design.task.start, load=lambda k: jump if 600 < k < 604 else 0.0)
    controller = design.adaptive(gains)
    _, y = close(controller, plant, 1000)
    assert controller.fallbacks == 1
    assert np.abs(y - controller.reference[:1000])[800:].max() < 0.05 * design.task.stroke


@pytest.mark.parametrize("lowest", [1.405, 1.453, 1.454])
def test_the_integral_does_not_wind_up_at_the_limit_of_the_voltage(design, gains, lowest):
    """For nine seconds the output stays above a reference that the lowest voltage does not reach.

    In the units of the equation and back, the first two limits are another number.
    """
    unreached = np.full_like(design.task.reference, design.rests[0][1] - 0.6 * design.task.stroke)
    task = replace(design.task, reference=unreached, limits=(lowest, 3.75))
    controller = replace(design, task=task).fixed(gains)
    short = np.where(np.arange(600) < 150, 0.0, 0.1 * task.stroke)
    inputs = np.array(outputs(controller, unreached[:600] + short))
    assert (inputs[150:] == lowest).mean() > 0.9
    assert abs(controller._feedback.integral) < 0.01 * task.stroke


AT_ONCE = NarxModel(  # y = 0.5 y(t-1) + 0.5 u(t), at rest at 2.4 and 0.5
    (Term.parse("y(t-1)"), Term.parse("u(t)")), np.array([0.5, 0.5]), SCALING
)


@pytest.mark.parametrize("at_once", [False, True])
def test_the_response_of_the_plan_is_that_of_its_simulation(design, at_once):
    """A small sine added to the reference: amplitude and angle of the inputs."""
    chosen = replace(design, model=AT_ONCE, rests=3 * [(2.4, 0.5)]) if at_once else design
    inverse, (u, y) = chosen.inverse(), chosen.rests[1]
    for frequency in (0.5, 3.0, 10.0):
        z = np.exp(2j * np.pi * np.array([frequency]) / RATE)
        response = dea.frequency_response(chosen.model, 1, [frequency], RATE, operating_point=u)
        expected = inverse_response(inverse, u, y, ResponseBand.exact(response), z)[0]
        count = 500
        v = 1e-5 * np.exp(2j * np.pi * frequency * np.arange(count) / RATE)
        inputs = []
        for part in (v.real, v.imag):
            inverse.rest(u, y)
            still = inverse.step(np.full(inverse.horizon, y))
            inverse.rest(u, y)
            found = []
            for each in part:
                found.append(inverse.step(np.full(inverse.horizon, y + each)) - still)
                inverse.advance()
            inputs.append(np.array(found))
        last = (inputs[0] + 1j * inputs[1])[-1] / v[-1]
        assert last == pytest.approx(expected, rel=2e-3)


def test_the_tuned_loop_keeps_its_margin_at_every_rest_for_its_band(design, gains):
    frequencies = loop_frequencies(RATE)
    z = np.exp(2j * np.pi * frequencies / RATE)
    least = []
    for u, y in design.rests:
        band = dea.frequency_response_band(design.model, 1, frequencies, RATE, operating_point=u)
        Q = inverse_response(design.inverse(), u, y, band, z)
        for gain in np.linspace(band.gain_low, band.gain_high, 5):
            for phase in np.linspace(band.phase_low, band.phase_high, 5):
                H = gain * np.exp(1j * np.radians(phase))
                least.append(np.abs(1.0 + gains.response(frequencies) * Q * H / z).min())
    assert 1 / 1.6 <= min(least) < 1.06 / 1.6


def test_rests_are_those_of_the_simulation(design):
    low, high = design.rests[0][1], design.rests[-1][1]
    wanted = np.array([low, 0.5 * (low + high), high])
    for u, y in rests_of(design.model, (1.6, 3.2), wanted):
        assert design.model.simulate(np.full(4000, u))[-1] == pytest.approx(y, abs=1e-6)
        assert np.abs(wanted - y).min() < 0.01 * (high - low)


def test_an_output_that_falls_with_the_input_is_refused():
    falling = np.where([not term.u_lags for term in TRUTH.terms], PARAMETERS, -PARAMETERS)
    with pytest.raises(InputError, match="rests at no output") as refused:
        design_for(NarxModel(TRUTH.terms, falling, SCALING))
    assert refused.value.field == "model"


def test_beyond_its_end_the_last_output_wanted_is_held(design, gains):
    size = design.task.reference.size
    own = design.proportional_integral()
    for controller in (design.adaptive(gains), design.fixed(gains), design.follower(own)):
        u, y = close(controller, Plant(design.task.start), size + 300)
        assert controller.reference.size == size
        assert np.isfinite(u).all()
        assert y[size + 100 :] == pytest.approx(design.task.reference[-1], abs=5 * NOISE)


@pytest.mark.parametrize(
    ("change", "field"),
    [({"start": 0.9}, "start"), ({"start": np.nan}, "start"), ({"limits": (1.0, np.inf)}, "limits"),
     ({"limits": (3.2, 1.6)}, "limits")],
)  # fmt: skip
def test_a_task_that_begins_outside_its_limits_is_refused(design, change, field):
    with pytest.raises(InputError) as refused:
        replace(design.task, **change)
    assert refused.value.field == field


@pytest.mark.parametrize("rate", [100.0, np.nan])
def test_a_design_at_another_rate_than_the_models_is_refused(design, rate):
    model = replace(design.model, labels=Labels(sampling_rate=RATE))
    u = np.full(6000, 2.4)
    with pytest.raises(InputError, match="sampling_rate"):
        ControllerDesign.of_record(model, u, u, rate, SETTINGS, 7)


def test_the_reference_is_approached_from_where_a_simulation_is_after_the_hold(design, monkeypatch):
    asked = []
    monkeypatch.setattr(
        "dea.control.design.whole_inverse",
        lambda simulate, reference, *rest, **settings: asked.append(reference),
    )
    design.inverse_of_simulation(lambda u: 0.01 * np.arange(u.size))  # creeps on for ever
    [wanted] = asked
    assert np.isnan(wanted[:50]).all()  # a second at 50 Hz
    assert wanted[50] == pytest.approx(0.5)
    np.testing.assert_allclose(wanted[100:], design.task.reference[100:])


def test_the_same_run_twice(design, gains):
    runs = [close(design.adaptive(gains), Plant(design.task.start), 600)[0] for _ in range(2)]
    assert np.array_equal(*runs)
