"""Simulations with two inputs against solutions that share nothing with the integrator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import two_inputs
from dea.discrepancy import Samples
from dea.errors import InputError
from dea.simulation import (
    ExtendedSimulation,
    ForcePort,
    Parameter,
    Simulation,
    State,
    catalogue,
    law_courses,
    load_extended,
    load_simulation,
    measured_scales,
    prepared,
    save_extended,
)
from dea.simulation.integrate import integrate
from two_inputs import INTERVAL, excitation, linear_simulation, simulation

SAMPLES = 120
P = {p.name: p.nominal for p in simulation.parameters}


def values_of(extended, **changed):
    values = extended.layout.prior_means
    for name, value in changed.items():
        values[extended.layout.names.index(name.replace("__", "."))] = value
    return values


def reference(u, right_gain=lambda t: 1.0, straight=False):
    """The device's output by an adaptive Runge-Kutta method, sample by sample."""
    x = np.array([0.3, 0.1])
    y = np.empty(len(u))
    for k, now in enumerate(u):
        y[k] = x[1] + 0.05 * now[1]
        after = u[min(k + 1, len(u) - 1)] if straight else now

        def slope(t, x, now=now, after=after, start=k * INTERVAL):
            left, right = now + (after - now) * t / INTERVAL
            gain = P["gain_right"] * right_gain(start)
            wall = -P["loss"] * x[0] - P["square_loss"] * x[0] * abs(x[0])
            wall += P["gain_left"] * left + gain * right**2
            return [wall, P["exchange"] * (x[0] - x[1]) + 0.1 * P["gain_left"] * left]

        x = solve_ivp(slope, (0.0, INTERVAL), x, rtol=1e-10, atol=1e-12).y[:, -1]
    return y


def test_a_linear_simulation_is_exact_under_held_inputs():
    u = excitation(SAMPLES)
    extended = ExtendedSimulation(linear_simulation)
    A = np.array([[-P["loss"], 0.0], [P["exchange"], -P["exchange"]]])
    B = np.array([[P["gain_left"], P["gain_right"]], [0.1 * P["gain_left"], 0.0]])
    whole = expm(INTERVAL * np.block([[A, B], [np.zeros((2, 4))]]))
    x, y = np.array([0.3, 0.1]), np.empty(SAMPLES)
    for k, now in enumerate(u):
        y[k] = x[1] + 0.05 * now[1]
        x = whole[:2, :2] @ x + whole[:2, 2:] @ now
    found = extended.simulate(values_of(extended), u, INTERVAL)
    assert np.abs(found - y).max() < 1e-9


@pytest.mark.parametrize("how", ["zero", "linear"])
def test_a_nonlinear_simulation_agrees_with_an_adaptive_method(how):
    u = excitation(SAMPLES)
    extended = ExtendedSimulation(replace(simulation, input_interpolation=how), substeps=64)
    found = extended.simulate(values_of(extended), u, INTERVAL)
    assert np.abs(found - reference(u, straight=how == "linear")).max() < 2e-5


def attached(name, place):
    u = excitation(SAMPLES)
    extended = replace(prepared(simulation, u, INTERVAL, 1e-6), timing_spread=0.0)
    record = Samples(u, reference(u), INTERVAL)
    scales = measured_scales(extended, values_of(extended), record, at_input=place)
    return extended.attach(catalogue()[name], scales, place), u


def test_a_delay_acts_on_its_own_input():
    extended, u = attached("transport_delay", 1)
    late = u.copy()
    late[:, 1] = np.concatenate([np.full(3, u[0, 1]), u[:-3, 1]])
    values = values_of(extended, **{"transport_delay@right__delay": 3 * INTERVAL})
    found = extended.simulate(values, u, INTERVAL)
    # The output takes the input as it acts.
    assert np.abs(found - reference(late)).max() < 1e-5
    (course,) = law_courses(extended, values, u, INTERVAL)
    assert course.along[1:] == ("right", "A")
    assert np.array_equal(course.value.values, late[:, 1])


def test_a_fault_scales_the_drive_of_its_own_input():
    extended, u = attached("step_fault", 1)
    step = {
        "step_fault@right__instant": 30.0,
        "step_fault@right__gain_step": -0.4,
        "step_fault@right__offset_step": 0.0,
        "step_fault@right__rise_time": 1e-6,
        "step_fault@right__scale_step": 0.0,
    }
    found = extended.simulate(values_of(extended, **step), u, INTERVAL)
    fault = reference(u, lambda t: 0.6 if t > 30.0 else 0.8 if t == 30.0 else 1.0)
    assert np.abs(found - fault).max() < 1e-5


def test_a_drive_for_all_inputs_is_one_place():
    shared = replace(simulation, drive="gain_left")
    extended = ExtendedSimulation(shared)
    drift = catalogue()["gain_drift"]
    assert extended.places.number_for(drift) == 1
    assert extended.places.number_for(catalogue()["transport_delay"]) == 2
    assert extended.places.label(attached("gain_drift", 0)[0].attached[0]) == "gain_drift"


def test_each_input_has_its_offset():
    u = excitation(SAMPLES)
    extended = ExtendedSimulation(simulation)
    assert extended.layout.input_offsets == ("input_offset.left", "input_offset.right")
    assert extended.layout.parameters[extended.layout.names.index("input_offset.right")].unit == "A"
    moved = values_of(extended, input_offset__left=0.3)
    expected = extended.simulate(values_of(extended), u + np.array([0.3, 0.0]), INTERVAL)
    assert np.array_equal(extended.simulate(moved, u, INTERVAL), expected)


def test_scales_are_those_of_one_input():
    extended, u = attached("dead_zone", 0)
    scales = extended.attached[0].scales
    assert (scales.u_unit, scales.u_low, scales.u_high) == ("V", u[:, 0].min(), u[:, 0].max())


def test_a_saved_extension_simulates_the_same(tmp_path):
    extended, u = attached("electrode_lag", 1)
    extended = replace(extended, simulation=load_simulation(two_inputs.__file__))
    values = values_of(extended)
    save_extended(extended, values, INTERVAL, tmp_path / "extended.yaml")
    again, read, interval = load_extended(tmp_path / "extended.yaml")
    assert again.layout.names == extended.layout.names
    assert again.places.label(again.attached[0]) == "electrode_lag@right"
    found = again.simulate(read, u, interval)
    assert np.array_equal(found, extended.simulate(values, u, INTERVAL))


def test_the_integrator_of_one_input_is_compiled_for_it_alone():
    assert len(integrate.nopython_signatures) == 1


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"input_name": ("left", "middle", "right")}, "it holds 3 for 2 inputs"),
        ({"input_name": "both"}, "it holds 1 for 2 inputs"),
        ({"input_unit": ("V",), "input_name": ("left",)}, "it holds 1 for 1 input"),
        ({"input_unit": "V"}, "it holds 2 for 1 input"),
        ({"drive": ("gain_left",)}, "it holds 1 for 2 inputs"),
        ({"drive": ("gain_left", "gain_left")}, "two inputs have 'gain_left'"),
        ({"drive": ("gain_left", "gain")}, "names 'gain', which is no parameter"),
        ({"input_name": ("left", "left")}, "two inputs have 'left'"),
        ({"input_name": ("left", "a+b")}, "holds one of @"),
        ({"input_offset_spread": (0.1, 0.1, 0.1)}, "it holds 3 for 2 inputs"),
        ({"derivative": lambda x, u, p, dx: dx.fill(u[2])}, "not declared"),
        ({"parameters": (Parameter("loss", "1/s", 1.0, 0.0),) * 2}, "two states or parameters"),
    ],
)
def test_what_does_not_fit_the_inputs_is_said_in_a_line(changed, said):
    with pytest.raises(InputError, match=said) as refused:
        replace(simulation, **changed)
    assert "\n" not in str(refused.value)


def test_a_record_of_other_inputs_is_refused():
    extended = ExtendedSimulation(simulation)
    with pytest.raises(InputError, match="it holds 1 for 2 inputs"):
        extended.simulate(values_of(extended), excitation(SAMPLES)[:, 0], INTERVAL)


@pytest.mark.parametrize(("name", "own"), [("two_heaters", 0), ("two_heaters_second", 1)])
def test_the_two_heaters_follow_their_published_heat_balance(name, own):
    """In kelvin, with the sizes that are published: 4 g, 500 J/(kg K), 10 and 2 cm^2, 0.9."""
    u = 30.0 * excitation(60)
    extended = ExtendedSimulation(load_simulation(name), substeps=8)
    found = extended.simulate(values_of(extended), u, 3.0)
    room, capacity, shine = 296.15, 0.004 * 500.0, 0.9 * 5.67e-8

    def balance(t, T, powers):
        passed = 20.0 * 2e-4 * (T[1] - T[0]) + shine * 2e-4 * (T[1] ** 4 - T[0] ** 4)
        lost = [10.0 * 1e-3 * (room - each) + shine * 1e-3 * (room**4 - each**4) for each in T[:2]]
        heated = [0.01 * powers[0], 0.0075 * powers[1]]
        return [
            (lost[0] + passed + heated[0]) / capacity,
            (lost[1] - passed + heated[1]) / capacity,
            (T[own] - T[2]) / 10.0,
        ]

    T, expected = np.full(3, room), []
    for powers in u:
        expected.append(T[2] - 273.15)
        T = solve_ivp(balance, (0.0, 3.0), T, args=(powers,), rtol=1e-9, atol=1e-9).y[:, -1]
    assert np.abs(found - expected).max() < 1e-3


def test_inputs_that_act_against_each_other_do_not_cancel_in_the_unit_of_force():
    """A tank's inflow less its outflow: each over its range moves the level by one per second."""

    def level(x, u, p, dx):
        dx[0] = p[0] * u[0] - p[1] * u[1]

    def reading(x, u, p):
        return x[0]

    tank = Simulation(
        name="tank",
        input_name=("in", "out"),
        input_unit=("V", "V"),
        output_unit="m",
        states=(State("x", "m", 1.0, 0.1),),
        parameters=(Parameter("inflow", "1", 1.0, 0.3), Parameter("outflow", "1", 1.0, 0.3)),
        derivative=level,
        output=reading,
        drive=("inflow", "outflow"),
        force_ports=(ForcePort("x", "x", None),),
    )
    u = np.repeat(np.random.default_rng(0).choice([0.0, 1.0], (40, 2)), 10, axis=0)
    (found,) = prepared(tank, u, 0.1, 1e-3).normalisations
    assert found.unit_force == pytest.approx(2.0)
