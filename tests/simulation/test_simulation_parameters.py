"""Priors, bounds and scales, and the step of integration that a record needs."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dea.errors import InputError
from dea.simulation import (
    ExtendedSimulation,
    ForcePort,
    Parameter,
    Scales,
    Simulation,
    State,
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
    with_fine_steps,
)
from dea.simulation.loading import built_in
from dea.simulation.preparation import slowest_time

DT = 0.02
T = np.arange(300) * DT


def test_a_coordinate_counts_spreads_from_the_nominal_value():
    plain = Parameter("offset", "V", 2.0, 0.5)
    log = Parameter("time", "s", 2.0, 0.5, log=True)
    assert [plain.value(c) for c in (-2.0, 0.0, 1.0)] == [1.0, 2.0, 2.5]
    assert [log.value(c) for c in (-2.0, 0.0, 1.0)] == pytest.approx(
        [2.0 / np.e, 2.0, 2.0 * np.sqrt(np.e)]
    )
    for parameter in (plain, log):
        assert parameter.coordinate_bounds() == (-np.inf, np.inf)
        assert parameter.coordinate(parameter.value(0.7)) == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("log", "low", "high", "bounds"),
    [
        (False, 1.0, 5.0, (-2.0, 6.0)),
        (True, 2.0 / np.e, 2.0 * np.e**2, (-2.0, 4.0)),
        (True, 0.0, 2.0 * np.e**2, (-np.inf, 4.0)),
        (True, -1.0, np.inf, (-np.inf, np.inf)),
        (False, 0.0, np.inf, (-4.0, np.inf)),
    ],
)
def test_the_bounds_of_a_value_are_those_of_its_coordinate(log, low, high, bounds):
    parameter = Parameter("any", "1", 2.0, 0.5, low, high, log=log)
    assert parameter.coordinate_bounds() == pytest.approx(bounds)
    for far, end in ((-1e3, low), (1e3, high)):
        if np.isfinite(end) and (end > 0.0 or not log):
            assert parameter.value(far) == pytest.approx(end, abs=1e-12)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"spread": -0.5}, r"parameters\.rate\.spread: it is -0\.5"),
        ({"low": 3.0, "high": 1.0}, r"parameters\.rate\.low: it is 3, and high is 1"),
        ({"nominal": 0.0, "log": True}, r"parameters\.rate\.nominal: it is 0, without"),
    ],
)
def test_a_prior_that_cannot_be_is_refused(changed, message):
    usual = {"nominal": 2.0, "spread": 0.0, "low": 2.0, "high": 2.0}
    Parameter("rate", "1/s", **usual)
    with pytest.raises(InputError, match=message):
        Parameter("rate", "1/s", **(usual | changed))


# Positive like a scale, but counted from a zero that is a convention.
FROM_A_ZERO = {"room", "limit", "upper_end", "highest_input", "lowest_input"}
TOLD = Scales("V", "V", 1.0, 4.0, 1.0, 0.5, 2.5, -1.0, 1.5, DT, 6.0, foreign_frequencies=(1.3,))


@pytest.mark.parametrize("owner", [*built_in(), *catalogue()])
def test_priors_leave_room_and_fit_positive_scales_by_their_logarithm(owner):
    effect = catalogue().get(owner)
    parameters = effect.parameters(TOLD) if effect else load_simulation(owner).parameters
    for parameter in parameters:
        assert parameter.low <= parameter.nominal <= parameter.high
        if parameter.spread > 0.0:
            assert parameter.low < parameter.high
        if parameter.low > 0.0 and parameter.name not in FROM_A_ZERO:
            assert parameter.log


def test_known_parameters_stay_within_three_spreads_and_those_of_a_law_within_their_own():
    simulation = load_simulation("mass_spring_damper")
    frequency, damping, gain = simulation.parameters
    close = replace(damping, low=0.05, high=0.2)
    simulation = replace(simulation, parameters=(frequency, close, gain))
    told = Scales("V", "V", -1, 1, 1.0, -1, 1, -1, 1, DT, 6.0)
    extended = ExtendedSimulation(simulation).attach(catalogue()["transport_delay"], told)
    low, high = extended.layout.bounds
    assert extended.layout.names[extended.layout.free[0]] == "natural_frequency"
    assert extended.layout.names[extended.layout.free[1]] == "damping_ratio"
    delay = [extended.layout.names[i] for i in extended.layout.free].index("transport_delay.delay")
    assert (low[0], high[0]) == (-3.0, 3.0)
    assert (low[1], high[1]) == pytest.approx((-np.log(2.0), np.log(2.0)))
    # From no delay to a tenth of the record, in spreads of four intervals.
    assert (low[delay], high[delay]) == pytest.approx((0.0, 0.6 / 0.08))


@pytest.mark.parametrize(
    ("low", "high", "bipolar", "peak"),
    [(-1, 3, True, 3), (0, 3, False, 3), (-3, 0, False, 3), (-0.15, 3, False, 3), (-3, 2, True, 3),
     (-0.17, 3, True, 3), (-3, 0.15, False, 3), (1, 3, False, 3)],
)  # fmt: skip
def test_an_input_is_bipolar_from_a_twentieth_of_its_range_on(low, high, bipolar, peak):
    scales = Scales("V", "mm", low, high, 1.0, 2.0, 2.5, -0.5, 1.0, DT, 6.0)
    assert scales.bipolar is bipolar
    assert scales.u_peak == peak
    assert (scales.u_span, scales.y_span, scales.z_span) == (high - low, 0.5, 1.5)


def test_scales_are_those_of_the_record_and_of_the_motion():
    simulation = load_simulation("mass_spring_damper")
    u = np.sin(2 * np.pi * 0.5 * T)
    # Half of the samples repeat the one before: a rate of zero is no rate of change.
    u = np.repeat(u[::2], 2)
    extended = prepared(simulation, u, DT, 1e-4)
    values = extended.layout.prior_means
    record = SimpleNamespace(u=u, y=3.0 * u - 1.0, interval=DT)
    found = measured_scales(extended, values, record)
    assert (found.u_low, found.u_high) == (u.min(), u.max())
    assert (found.y_low, found.y_high) == (record.y.min(), record.y.max())
    assert (found.interval, found.duration) == (DT, pytest.approx(6.0))
    changes = np.sort(np.abs(np.diff(u[::2]))) / DT
    assert changes[-5] < found.u_rate <= changes[-1]
    assert changes[-1] == pytest.approx(np.pi * 2, rel=0.01)  # two intervals of a slope of pi
    # The carriage follows its slow input to either side: one at the largest excursion.
    assert max(found.z_high, -found.z_low) == pytest.approx(1.0)
    assert min(found.z_high, -found.z_low) > 0.9
    # It follows each step of the input within the first of its two intervals.
    assert found.z_rate == pytest.approx(2.0 * np.pi, rel=0.1)
    assert found.crossing == pytest.approx(found.z_span / found.z_rate)
    assert replace(found, duration=2.0).crossing == 0.2


def test_a_simulation_that_does_not_move_takes_the_scale_of_its_prior():
    simulation = load_simulation("mass_spring_damper")
    u = np.sin(2 * np.pi * 0.5 * T)
    extended = prepared(simulation, u, DT, 1e-4)
    values = extended.layout.prior_means
    gain = extended.layout.names.index("static_gain")
    record = SimpleNamespace(u=u, y=u, interval=DT)
    for share, high in ((0.1, 1.0), (0.2, 1.0), (0.4, 0.4), (2.0, 2.0)):
        values[gain] = share
        assert measured_scales(extended, values, record).z_high == pytest.approx(high, rel=1e-2)


@pytest.mark.parametrize(("damping", "slowest"), [(0.2, 5.0), (1.25, 2.0), (0.5, 2.0)])
def test_the_slowest_time_is_that_of_the_slowest_pole(damping, slowest):
    """A carriage of 1 rad/s: its poles are -d ± sqrt(d^2 - 1)."""
    own = load_simulation("mass_spring_damper")
    frequency, ratio, gain = own.parameters
    parameters = (
        replace(frequency, nominal=1 / (2 * np.pi)), replace(ratio, nominal=damping), gain
    )  # fmt: skip
    extended = ExtendedSimulation(replace(own, parameters=parameters))
    assert slowest_time(extended, np.ones(10)) == pytest.approx(slowest, rel=1e-4)


def test_a_shaft_that_turns_freely_has_no_slowest_time_of_its_own():
    """Motor and load on a shaft: both angles may turn, the twist of 20 rad/s fades in 0.25 s."""
    own = load_simulation("mass_spring_damper")

    def derivative(x, u, p, dx):
        torque = 200.0 * (x[0] - x[2]) + 4.0 * (x[1] - x[3])
        dx[0], dx[1] = x[1], u - torque
        dx[2], dx[3] = x[3], torque

    states = tuple(replace(own.states[0], name=f"x{i}", initial=0.3) for i in range(4))
    free = ExtendedSimulation(replace(own, states=states, derivative=derivative, force_ports=()))
    assert slowest_time(free, np.zeros(10)) == pytest.approx(0.25, rel=1e-3)


def test_the_slowest_time_is_that_of_a_small_motion():
    """A damper that is twice as strong a tenth of a unit away from rest."""
    own = load_simulation("piezo_stage")

    def derivative(x, u, p, dx):
        dx[0] = -0.5 * x[0] * (1.0 + 100.0 * x[0] * x[0])

    still = replace(own, states=(replace(own.states[0], initial=0.0),), derivative=derivative)
    assert slowest_time(ExtendedSimulation(still), np.zeros(10)) == pytest.approx(2.0, rel=1e-4)


def test_steps_are_refined_until_the_output_keeps_within_the_tolerance():
    tanks = load_simulation("cascaded_tanks")
    u = 3.0 + 2.0 * np.sign(np.sin(0.3 * np.arange(200)))
    coarse = ExtendedSimulation(tanks)
    values = coarse.layout.prior_means
    exact = replace(coarse, substeps=256).simulate(values, u, 40.0)
    before = 1
    for tolerance in (1.0, 1e-2, 1e-3, 1e-4):
        fine = with_fine_steps(coarse, values, u, 40.0, tolerance)
        error = np.sqrt(np.mean((fine.simulate(values, u, 40.0) - exact) ** 2))
        # From one number of steps to the next, more than a third of the error goes.
        assert error < 3.0 * tolerance
        assert fine.substeps >= before
        before = fine.substeps
    assert before > 2
    assert with_fine_steps(coarse, values, u, 40.0, 1e-12, most=4).substeps == 4


def pendulum(torque):
    """A pendulum, the torque on it at samples of 20 ms, and its finest simulation."""

    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = -p[0] * math.sin(x[0]) - p[1] * x[1] + p[2] * u

    def output(x, u, p):
        return x[0]

    own = Simulation(
        name="pendulum",
        input_unit="1/s^2",
        output_unit="rad",
        states=(State("angle", "rad", 0.0, 0.02), State("rate", "rad/s", 0.0, 0.05)),
        parameters=(
            Parameter("gravity", "1/s^2", 38.0, 0.1, 1.0, 1e3, log=True),
            Parameter("damping", "1/s", 0.3, 0.7, 0.01, 10.0, log=True),
            Parameter("gain", "1", 1.0, 0.2, 0.1, 1e3, log=True),
        ),
        derivative=derivative,
        output=output,
        drive="gain",
        force_ports=(ForcePort(equation="rate", position="angle", velocity="rate"),),
    )
    extended = ExtendedSimulation(own, substeps=256)
    y = extended.simulate(extended.layout.prior_means, torque, DT)
    return own, y


def test_a_motion_that_no_step_settles_gets_the_steps_of_its_settled_part():
    """Driven ever harder, it swings over the top, where the step decides to which side it falls."""
    time = np.arange(1500) * DT
    torque = (4.0 + 2.0 * time) * np.sin(4.0 * time)
    own, exact = pendulum(torque)
    assert np.abs(exact).max() > 2 * np.pi
    found = prepared(own, torque, DT, 1e-3)
    assert 1 < found.substeps <= 32
    below = slice(0, int(np.argmax(np.abs(exact) > 2.0)))
    y = found.simulate(found.layout.prior_means, torque, DT)
    assert np.sqrt(np.mean((y - exact)[below] ** 2)) < 3e-3


def test_a_motion_that_finer_steps_settle_gets_the_finest_where_none_suffices():
    torque = 4.0 * np.sin(5.5 * T)
    own, _ = pendulum(torque)
    assert prepared(own, torque, DT, 1e-9).substeps == 256


def test_a_linear_simulation_needs_one_step():
    simulation = replace(load_simulation("mass_spring_damper"), input_interpolation="zero")
    assert prepared(simulation, np.sign(np.sin(3 * T)), DT, 1e-4).substeps == 1
