"""Force laws within the integrator, against other integrators."""

from dataclasses import replace
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
from made_wheel import wheel
from scipy.integrate import solve_ivp

from dea.simulation import (
    ForcePort,
    Parameter,
    Simulation,
    State,
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
)
from dea.simulation.signatures import MEMORY

DT = 0.02
T = np.arange(150) * DT
U = np.sin(2 * pi * 0.7 * T)


def attached(simulation, name, law, substeps):
    """Return a simulation with a law, its parameter values, and the units of its port."""
    extended = prepared(simulation, U, DT, 1e-5)
    values = extended.layout.prior_means
    scales = measured_scales(extended, values, SimpleNamespace(u=U, y=U, interval=DT))
    longer = replace(extended.attach(catalogue()[name], scales), substeps=substeps)
    # Compiled laws check no indices: a shorter one would be read beyond its end.
    assert len(law) == len(longer.attached[0].parameters)
    return longer, np.concatenate([values, law]), extended.normalisations[0]


@pytest.mark.parametrize("gain", [1e-3, 1.0, 1e3])
def test_a_step_sees_the_stop_that_it_runs_into_whatever_the_unit_of_length(gain):
    omega, zeta = 2 * pi * 2.0, 0.2
    own = load_simulation("mass_spring_damper")

    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = omega * omega * (p[0] * u - x[0]) - 2.0 * zeta * omega * x[1]

    simulation = replace(
        own, name="carriage", derivative=derivative, input_interpolation="zero",
        parameters=(replace(own.parameters[2], nominal=gain, low=0.0, high=1e9),),
    )  # fmt: skip
    law = [0.5, -9.0, 30.0, 0.005, 1.0, 0.1, 0.0, 0.5]  # at half the excursion, with a sharp corner
    extended, values, unit = attached(simulation, "end_stop", law, substeps=2)
    contact = catalogue()["end_stop"].force

    def slope(_, x, v):
        z, w = (x[0] - unit.rest) / unit.scale, x[1] / unit.scale
        push = unit.unit_force * contact(z, w, np.zeros(MEMORY), np.array(law))
        return [x[1], omega**2 * (gain * v - x[0]) - 2.0 * zeta * omega * x[1] + push]

    x, expected = np.zeros(2), []
    for v in U:
        expected.append(x[0])
        x = solve_ivp(
            slope, (0, DT), x, args=(v,), rtol=1e-8, atol=1e-10 * gain, max_step=DT / 20
        ).y[:, -1]
    found = extended.simulate(values, U, DT)
    np.testing.assert_allclose(found, expected, atol=4e-3 * np.ptp(expected))


@pytest.mark.parametrize("order", [("speed", "behind"), ("behind", "speed")])
def test_friction_where_no_state_is_a_position_acts_on_the_speed_wherever_it_stands(order):
    speed, behind = order.index("speed"), order.index("behind")

    def derivative(x, u, p, dx):
        dx[speed] = (p[0] * u - x[speed]) / 0.2
        dx[behind] = (x[speed] - x[behind]) / 0.1

    simulation = Simulation(
        name="wheel", input_unit="V", output_unit="m/s",
        states=tuple(State(name, "m/s", 0.0) for name in order),
        parameters=(Parameter("gain", "m/s/V", 2.0, 0.2),), derivative=derivative,
        output=lambda x, u, p: x[behind], drive="gain", input_interpolation="zero",
        force_ports=(ForcePort("speed", None, "speed"),),
    )  # fmt: skip
    # Stiction that the speed ends, by which a wrong speed shows.
    law = np.array([0.2, 0.02, 2.0, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0])
    extended, values, unit = attached(simulation, "coulomb_friction", law, substeps=2)
    friction = catalogue()["coulomb_friction"]
    memory, fine = friction.memory(law), 2000
    v = after = place = 0.0
    expected, h = [], DT / fine
    for u in U:
        expected.append(after)
        for _ in range(fine):
            push = unit.unit_force * friction.force(place, v / unit.scale, memory, law)
            v_next = v + h * ((2.0 * u - v) / 0.2 + push)
            after += h * (v - after) / 0.1
            moved = place + 0.5 * h * (v + v_next) / unit.scale
            friction.update(place, moved, h, memory, law)
            v, place = v_next, moved
    found = extended.simulate(values, U, DT)
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.ptp(expected))


def test_friction_holds_a_wheel_before_the_record_that_has_no_place_to_rest_at():
    """An input that friction withstands, from a lead-in on: a kept force would turn the wheel."""
    simulation = wheel(lead_in=2.0)
    law = np.array([5.0, 0.02, 0.0, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0])
    extended, values, _ = attached(simulation, "coulomb_friction", law, substeps=16)
    found = extended.simulate(values, np.full(100, 1e-3), DT)
    assert np.abs(found).max() < 1e-4
    none = np.array([0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0])
    free, own, _ = attached(simulation, "coulomb_friction", none, substeps=1)
    assert free.simulate(own, np.full(100, 1e-3), DT)[-1] == pytest.approx(2e-3, rel=1e-3)
    assert not free.attached[0].scales.placed


@pytest.mark.parametrize(("grounded", "hardening", "side"), [(0.0, 0.0, 0.0), (0.4, 4.0, 0.5)])
def test_half_the_step_leaves_a_quarter_of_the_error_of_a_second_mass(grounded, hardening, side):
    """The whole device, which starts off with a speed, is solved anew at a fine tolerance."""
    omega, zeta, coupling, own, damping = 2 * pi * 1.5, 0.3, 0.3, 2 * pi * 4.0, 0.3

    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = omega * omega * (p[0] * u - x[0]) - 2.0 * zeta * omega * x[1]

    simulation = Simulation(
        name="carriage", input_unit="V", output_unit="mm",
        states=(State("position", "mm", 0.0), State("velocity", "mm/s", 5.0)),
        parameters=(Parameter("gain", "mm/V", 1.0, 0.2),), derivative=derivative,
        output=lambda x, u, p: x[0], drive="gain", input_interpolation="linear",
        force_ports=(ForcePort("velocity", "position", "velocity"),),
    )  # fmt: skip
    law = [coupling, 4.0, damping, 0.0, hardening, grounded, side, 0.0]

    def slope(t, x, unit):
        z, w, a, v = (x[0] - unit.rest) / unit.scale, x[1] / unit.scale, x[2], x[3]
        stretch = z - a
        spring = np.exp(side * np.sign(stretch)) * (1.0 + hardening * stretch**2) * stretch
        slide = 2.0 * damping / own * (1.0 - grounded) * (w - v)
        push = -coupling * unit.unit_force * (spring + slide)
        pull = own**2 * (spring + slide) - 2.0 * damping * own * grounded * v
        free = omega**2 * (np.interp(t, T, U) - x[0]) - 2.0 * zeta * omega * x[1]
        return [x[1], free + push, v, pull]

    tried = [attached(simulation, "second_mode", law, substeps) for substeps in (1, 2, 4)]
    _, _, unit = tried[0]
    expected = solve_ivp(
        slope, (0, T[-1]), [0.0, 5.0, 0.0, 0.0], args=(unit,), t_eval=T, rtol=1e-9, atol=1e-9,
        max_step=DT / 4,
    ).y[0]  # fmt: skip
    errors = [np.std(device.simulate(values, U, DT) - expected) for device, values, _ in tried]
    plain = prepared(simulation, U, DT, 1e-5)
    alone = plain.simulate(plain.layout.prior_means, U, DT)
    assert errors[0] < 0.03 * np.std(alone - expected)
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.15)


@pytest.mark.parametrize(("grounded", "hardening", "side"), [(0.0, 0.0, 0.0), (0.4, 4.0, 0.5)])
def test_a_flywheel_on_a_soft_shaft_is_a_second_mass_where_a_speed_alone_is_known(
    grounded, hardening, side
):
    """Both angles and speeds are solved anew, from rest on."""
    friction, ratio, own, damping = 5.0, 0.4, 2 * pi * 3.0, 0.2

    def derivative(x, u, p, dx):
        dx[0] = friction * (p[0] * u - x[0])

    simulation = Simulation(
        name="motor", input_unit="V", output_unit="rad/s",
        states=(State("speed", "rad/s", 0.0),),
        parameters=(Parameter("gain", "rad/s/V", 2.0, 0.2),), derivative=derivative,
        output=lambda x, u, p: x[0], drive="gain", input_interpolation="linear",
        force_ports=(ForcePort("speed", None, "speed"),),
    )  # fmt: skip

    def slope(t, x, unit):
        angle, speed, behind, other = x
        twist = angle - behind
        # The shaft hardens in terms of the twist by the motor's unit of torque.
        twisted = own**2 * twist / unit.unit_force
        spring = np.exp(side * np.sign(twist)) * (1.0 + hardening * twisted**2) * twist
        torque = own**2 * spring + 2.0 * damping * own * (1.0 - grounded) * (speed - other)
        free = friction * (2.0 * np.interp(t, T, U) - speed)
        return [
            speed,
            free - ratio * torque,
            other,
            torque - 2.0 * damping * own * grounded * other,
        ]

    law = [ratio, 3.0, damping, 0.0, hardening, grounded, side]
    tried = []
    for substeps in (1, 2, 4):
        extended = prepared(simulation, U, DT, 1e-5)
        tried.append(
            attached(
                simulation, "second_mode", [*law, extended.normalisations[0].inertia], substeps
            )
        )
    _, _, unit = tried[0]
    assert unit.unit_force == pytest.approx(friction * unit.scale, rel=1e-6)
    expected = solve_ivp(
        slope, (0, T[-1]), np.zeros(4), args=(unit,), t_eval=T, rtol=1e-9, atol=1e-9,
        max_step=DT / 4,
    ).y[1]  # fmt: skip
    errors = [np.std(device.simulate(values, U, DT) - expected) for device, values, _ in tried]
    plain = prepared(simulation, U, DT, 1e-5)
    alone = plain.simulate(plain.layout.prior_means, U, DT)
    assert errors[0] < 0.03 * np.std(alone - expected)
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.25)


@pytest.mark.parametrize("unit", [1e-13, 1e13])
def test_a_simulation_runs_in_every_unit(unit):
    """A first-order lag, whose response to a step is known, with its output in pm or in Gm."""

    def lag(x, u, p, dx):
        dx[0] = (p[0] * u - x[0]) / p[1]

    def reading(x, u, p):
        return x[0]

    simulation = Simulation(
        name="lag",
        input_unit="V",
        output_unit="m",
        states=(State("x", "m", 0.0),),
        parameters=(Parameter("gain", "m/V", unit, 0.1), Parameter("time", "s", 0.2, 0.1)),
        derivative=lag,
        output=reading,
        drive="gain",
        force_ports=(),
    )
    extended = prepared(simulation, np.ones(100), 0.02, 1e-6 * unit)
    found = extended.simulate(extended.layout.prior_means, np.ones(100), 0.02)
    exact = unit * (1.0 - np.exp(-np.arange(100) * 0.02 / 0.2))
    np.testing.assert_allclose(found, exact, rtol=1e-6, atol=1e-9 * unit)
