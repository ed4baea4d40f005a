"""Simulations, their integration, and a user's own."""

import subprocess
import sys
from dataclasses import replace
from itertools import permutations
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from law_values import SCALES
from numba import njit
from numba.core.errors import NumbaError
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from dea.errors import InputError
from dea.simulation import (
    Attached,
    ExtendedSimulation,
    ForcePort,
    Normalisation,
    Parameter,
    SensorFilter,
    Simulation,
    State,
    catalogue,
    load_extended,
    load_simulation,
    measured_scales,
    prepared,
    save_extended,
)
from dea.simulation import extended as extended_simulation
from dea.simulation import integrate as integrator
from dea.simulation.arguments import Equations, ForceLaw
from dea.simulation.loading import _explained, built_in
from dea.simulation.signatures import OUTPUT, SLOTS, compiled, no_force, no_update
from user_simulation import SLOPE, write_simulation

DT = 0.02
T = np.arange(300) * DT


def reference(simulation, u, interval, slopes=None):
    """Free run under a held input by another integrator."""
    p, x = simulation.nominal, np.array([s.initial for s in simulation.states])
    right = slopes or simulation.derivative
    lead = round(simulation.lead_in / interval)
    outputs = []

    def slope(_, x, v):
        dx = np.empty(x.size)
        right(x, v, p, dx)
        return dx

    for v in np.concatenate([np.full(lead, u[0]), u]):
        outputs.append(simulation.output(x, v, p))
        x = solve_ivp(slope, (0, interval), x, args=(v,), rtol=1e-10, atol=1e-13, method="LSODA").y[
            :, -1
        ]
    return np.array(outputs[lead:])


@pytest.mark.parametrize(
    ("name", "u", "interval", "tolerance"),
    [
        ("dea_membrane", 2.4 + np.sin(4 * T), DT, 1e-5),
        ("dea_film", 2.4 + np.sin(4 * T), DT, 1e-5),
        ("cascaded_tanks", 3.0 + np.sin(0.3 * T / DT * 0.1), 4.0, 1e-3),
        ("electric_drive", np.sign(np.sin(3 * T)), DT, 1e-6),
    ],
)
def test_integration_agrees_with_another_method(name, u, interval, tolerance):
    lead = 0.2 if name.startswith("dea") else 0.0
    simulation = replace(load_simulation(name), lead_in=lead, sensor_filter=None)
    extended = ExtendedSimulation(simulation, substeps=2)
    values = extended.layout.prior_means
    found = extended.simulate(values, u, interval)
    assert np.allclose(found, reference(simulation, u, interval), atol=tolerance)


def test_one_step_is_exact_for_a_stiff_linear_system():
    simulation = load_simulation("mass_spring_damper")
    stiff = replace(simulation, input_interpolation="zero")
    extended = ExtendedSimulation(stiff)
    values = extended.layout.prior_means
    values[0], values[1] = 40.0, 12.0
    u = np.where(T > 1.0, 1.0, 0.2)
    found = extended.simulate(values, u, DT)
    finer = ExtendedSimulation(stiff, substeps=64).simulate(values, u, DT)
    assert np.allclose(found, finer, atol=1e-6)


@pytest.mark.parametrize(("frequency", "damping"), [(8.0, 0.05), (8.0, 1.0), (1.0, 3.0)])
@pytest.mark.parametrize("states", [2, 3])
def test_one_step_is_exact_for_an_input_that_is_straight_between_samples(
    frequency, damping, states
):
    own = replace(load_simulation("mass_spring_damper"), input_interpolation="linear")

    def derivative(x, u, p, dx):
        omega = 6.283185307179586 * p[0]
        dx[0] = x[1]
        dx[1] = omega * omega * (p[2] * u - x[0]) - 2.0 * p[1] * omega * x[1]
        if x.size > 2:
            dx[2] = 30.0 * (x[0] - x[2])

    def output(x, u, p):
        return x[x.size - 1] if x.size > 2 else x[0]

    more = (State("behind", "V", 0.0),) if states == 3 else ()
    simulation = replace(
        own, derivative=derivative, output=output, states=(*own.states, *more), force_ports=()
    )
    extended = ExtendedSimulation(simulation)
    values = extended.layout.prior_means
    values[:3] = frequency, damping, 1.5
    start = np.array([0.1, 5.0, 0.2])[:states]
    values[3 : 3 + states] = start
    u = np.random.default_rng(3).standard_normal(T.size)
    omega = 2 * pi * frequency
    A = np.array([[0.0, 1.0, 0.0], [-(omega**2), -2 * damping * omega, 0.0], [30.0, 0.0, -30.0]])
    system = (
        A[:states, :states],
        np.array([[0.0], [1.5 * omega**2], [0.0]])[:states],
        np.eye(states)[[2 if states == 3 else 0]],
        np.zeros((1, 1)),
    )
    _, expected, _ = lsim(system, u, T, X0=start)
    assert np.allclose(extended.simulate(values, u, DT), expected, atol=1e-5)


@pytest.mark.parametrize("states", [2, 3])
def test_integrators_in_a_row_give_powers_of_time(states):
    """All eigenvalues are zero and equal, where the formulas of the step divide by neither."""

    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = p[0] * u
        if x.size > 2:
            dx[2] = x[0]

    def output(x, u, p):
        return x[x.size - 1] if x.size > 2 else x[0]

    names = ("position", "velocity", "integral")[:states]
    simulation = Simulation(
        name="integrators", input_unit="V", output_unit="m",
        states=tuple(State(name, "m", 0.0) for name in names),
        parameters=(Parameter("gain", "1", 2.0, 0.2),), derivative=derivative, output=output,
        drive="gain", force_ports=(), input_interpolation="linear",
    )  # fmt: skip
    extended = ExtendedSimulation(simulation)
    found = extended.simulate(extended.layout.values(np.zeros(1)), T, DT)
    expected = 2.0 * (T**3 / 6.0 if states == 2 else T**4 / 24.0)
    assert np.allclose(found, expected, rtol=1e-6, atol=1e-8)


def cubic(extended, stiffening):
    """Return the parameters of an attached stiffening that is a cube."""
    law = [p.nominal for p in extended.attached[0].parameters]
    return [stiffening, 3.0, *law[2:]]


def test_a_force_enters_at_its_port():
    simulation = replace(load_simulation("mass_spring_damper"), input_interpolation="zero")
    u = np.sin(2 * np.pi * 3 * T)
    extended = prepared(simulation, u, DT, 1e-6)
    extended = replace(extended, substeps=16)
    values = extended.layout.prior_means
    record = SimpleNamespace(u=u, y=u, interval=DT)
    stiffer = extended.attach(
        catalogue()["strain_stiffening"], measured_scales(extended, values, record)
    )
    unit = extended.normalisations[0]
    omega = 2 * pi * simulation.nominal[0]
    assert unit.unit_force == pytest.approx(omega**2 * unit.scale, rel=1e-6)

    def slopes(x, v, p, dx):
        simulation.derivative(x, v, p, dx)
        dx[1] -= unit.unit_force * 0.4 * (x[0] / unit.scale) ** 3

    found = stiffer.simulate(np.concatenate([values, cubic(stiffer, 0.4)]), u, DT)
    assert np.allclose(found, reference(simulation, u, DT, slopes), atol=2e-3)


def test_a_simulation_that_runs_away_is_not_a_number():
    def unstable(x, u, p, dx):
        dx[0] = p[0] * x[0] + u

    simulation = Simulation(
        name="runaway", input_unit="V", output_unit="mm", states=(State("x", "mm", 0.0),),
        parameters=(Parameter("growth", "1/s", 30.0, 1.0),), derivative=unstable,
        output=lambda x, u, p: x[0], drive="growth", force_ports=(),
    )  # fmt: skip
    extended = ExtendedSimulation(simulation)
    found = extended.simulate(extended.layout.values(np.zeros(1)), np.ones(300), DT)
    assert np.isfinite(found[:10]).all()
    assert np.isnan(found[-1])
    with pytest.raises(InputError, match=r"runaway.*runs away at its nominal"):
        prepared(simulation, np.ones(300), DT, 1e-3)


def test_an_output_that_is_not_a_number_is_told_from_a_state_that_runs_away():
    def falling(x, u, p, dx):
        dx[0] = -p[0]

    simulation = Simulation(
        name="rooted", input_unit="V", output_unit="mm", states=(State("level", "mm", 1.0),),
        parameters=(Parameter("rate", "1/s", 1.0, 1.0),), derivative=falling,
        output=lambda x, u, p: x[0] ** 0.5, drive="rate",
        force_ports=(ForcePort("level", "level", None),),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"rooted: output: it is not a number .* after 1 s"):
        prepared(simulation, np.ones(300), DT, 1e-3)


@pytest.mark.parametrize("name", built_in())
def test_a_simulation_of_the_study_loads(name):
    simulation = load_simulation(name)
    assert simulation.name == name
    assert simulation.force_ports


def test_an_extended_simulation_saves_and_loads(tmp_path):
    u = 2.4 + np.sin(4 * T)
    extended = prepared(load_simulation("dea_membrane"), u, DT, 1e-4)
    values = extended.layout.prior_means
    record = SimpleNamespace(u=u, y=u, interval=DT)
    told = measured_scales(extended, values, record)
    for name in ("viscoelastic_creep", "dead_zone", "input_saturation"):
        effect = catalogue()[name]
        extended = extended.attach(effect, told, upstream=name == "input_saturation")
        values = np.concatenate([values, effect.starts(told)[0]])
    path = tmp_path / "extended_simulation.yaml"
    save_extended(extended, values, DT, path)
    loaded, same, interval = load_extended(path)
    assert interval == DT
    assert (loaded.simulate(same, u, DT) == extended.simulate(values, u, DT)).all()
    text = path.read_text()
    path.write_text(text.replace("dead_zone", "dead_zoo"))
    with pytest.raises(InputError, match=r"yaml: effects: there is no effect 'dead_zoo'"):
        load_extended(path)
    # A file made before the law had got a parameter.
    path.write_text(text.replace("dead_zone.bend", "dead_zone.bent"))
    with pytest.raises(InputError, match=r"parameters\.dead_zone\.bend: it has no value"):
        load_extended(path)
    path.write_text(text.replace("interval: ", "interval: about "))
    with pytest.raises(InputError, match="it is no extended simulation"):
        load_extended(path)


@pytest.mark.parametrize("text", ["a: [", "[1, 2]", "4.0", "", "effects:\neffects:\n"])
def test_a_file_that_is_no_saved_simulation_is_refused_on_one_line(tmp_path, text):
    path = tmp_path / "extended_simulation.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as refused:
        load_extended(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("slow", "limit"), [("slew_limit", "input_saturation"), ("sensor_lag", "output_saturation")]
)
def test_a_signal_meets_the_laws_on_its_way_from_upstream_down(slow, limit):
    u = 3.0 * np.sin(4 * T)
    extended = prepared(load_simulation("mass_spring_damper"), u, DT, 1e-3)
    own = extended.layout.prior_means
    y = extended.simulate(own, u, DT)
    record = SimpleNamespace(u=u, y=y, interval=DT)
    told = measured_scales(extended, own, record)

    def simulated(first, then, upstream):
        effects = [catalogue()[name] for name in (first, then)]
        longer = extended.attach(effects[0], told).attach(effects[1], told, upstream=upstream)
        laws = [effect.starts(told)[0] for effect in effects]
        return longer.simulate(np.concatenate([own, *laws]), u, DT)

    slow_first = simulated(slow, limit, upstream=False)
    assert (slow_first == simulated(limit, slow, upstream=True)).all()
    assert not np.allclose(slow_first, simulated(slow, limit, upstream=True))


def write_own(path, slope=SLOPE, drive="gain", equation="level"):
    ports = f'drive="{drive}", force_ports=(ForcePort("{equation}", "level", None),),'
    return write_simulation(path, slope, ports)


def test_a_users_simulation_loads_and_runs(tmp_path):
    simulation = load_simulation(write_own(tmp_path / "own.py"))
    extended = ExtendedSimulation(simulation)
    found = extended.simulate(extended.layout.prior_means, np.ones(300), DT)
    assert np.allclose(found, 1 - np.exp(-2.0 * T), atol=1e-6)


def test_a_users_simulation_is_found_again_by_what_is_saved(tmp_path):
    extended = ExtendedSimulation(load_simulation(write_own(tmp_path / "own.py")))
    values = extended.layout.values(np.full(extended.layout.free.size, 0.3))
    path = tmp_path / "extended_simulation.yaml"
    save_extended(extended, values, DT, path)
    loaded, same, _ = load_extended(path)
    u = np.sin(T)
    assert (loaded.simulate(same, u, DT) == extended.simulate(values, u, DT)).all()


def test_what_is_saved_keeps_how_the_input_behaves(tmp_path):
    linear = replace(load_simulation("mass_spring_damper"), input_interpolation="linear")
    extended = ExtendedSimulation(linear)
    values = extended.layout.prior_means
    save_extended(extended, values, DT, tmp_path / "extended.yaml")
    assert load_extended(tmp_path / "extended.yaml")[0].simulation.input_interpolation == "linear"


def test_a_function_is_compiled_anew_unless_it_is_compiled_just_so():
    own = load_simulation("mass_spring_damper")
    assert own.compiled_derivative is own.derivative

    @njit
    def output(x, u, p):
        return 1.0 / x[0]

    assert output(np.ones(1), 0.0, np.ones(1)) == 1.0
    assert compiled(output, OUTPUT)(np.zeros(1), 0.0, np.ones(1)) == np.inf


def test_only_so_many_forces_can_be_attached():
    simulation = load_simulation("mass_spring_damper")
    u = np.sin(T)
    extended = prepared(simulation, u, DT, 1e-3)
    values = extended.layout.prior_means
    record = SimpleNamespace(u=u, y=u, interval=DT)
    told = measured_scales(extended, values, record)
    for name in ("coulomb_friction", "end_stop", "second_mode"):
        extended = extended.attach(catalogue()[name], told)
    extended = extended.attach(catalogue()["dead_zone"], told)
    with pytest.raises(InputError, match="3 forces are attached already"):
        extended.attach(catalogue()["viscoelastic_creep"], told)


REMEMBERING = ("stress_relaxation", "viscoelastic_creep", "second_mode")


def pushed(names):
    """Return a carriage on which forces with memory act, its parameter values and an input."""
    u = np.sin(2 * np.pi * 0.7 * T)
    extended = prepared(load_simulation("mass_spring_damper"), u, DT, 1e-4)
    values = extended.layout.prior_means
    scales = measured_scales(extended, values, SimpleNamespace(u=u, y=u, interval=DT))
    laws = {name: catalogue()[name].starts(scales)[0] for name in REMEMBERING}
    laws["stress_relaxation"] = (0.5, 0.5, 0.8, 0.3)
    for name in names:
        extended = extended.attach(catalogue()[name], scales)
    return extended, np.concatenate([values, *(laws[name] for name in names)]), u


@pytest.mark.parametrize("names", [REMEMBERING[:2], REMEMBERING[::2], REMEMBERING[1:], REMEMBERING])
def test_forces_add_up_in_any_order(names):
    def output(order):
        extended, values, u = pushed(order)
        return extended.simulate(values, u, DT)

    expected = output(names)
    alone = output(names[:1])
    assert np.abs(expected - alone).max() > 1e-2
    for order in permutations(names):
        np.testing.assert_allclose(output(order), expected, atol=1e-6)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_the_integrator_stays_within_its_arrays(monkeypatch, count):
    """Compiled code checks no index; the same steps in Python do."""
    extended, values, u = pushed(REMEMBERING[:count])
    compiled_run = extended.run(values, u[:50], DT)
    empty = [ForceLaw(no_force, no_update)] * (SLOTS - count)
    laws = [ForceLaw(a.effect.force, a.effect.update) for a in extended.attached]
    own = extended.simulation

    def interpreted(_, *arguments):
        equations = Equations(own.compiled_derivative, own.compiled_output, *laws, *empty)
        return integrator.integrate.py_func(equations, *arguments)

    monkeypatch.setattr(integrator, "_positions", integrator._positions.py_func)
    monkeypatch.setattr(integrator, "borrowed", lambda array: array)
    monkeypatch.setattr(extended_simulation, "integrate", interpreted)
    np.testing.assert_allclose(extended.run(values, u[:50], DT), compiled_run, rtol=1e-6, atol=1e-9)


def test_a_constant_can_add_to_the_input(tmp_path):
    own = replace(load_simulation(write_own(tmp_path / "own.py")), input_offset_spread=0.5)
    extended = ExtendedSimulation(own)
    values = extended.layout.prior_means
    values[extended.layout.names.index("input_offset")] = 0.4
    moved = extended.simulate(values, np.sin(T), DT)
    values[extended.layout.names.index("input_offset")] = 0.0
    assert np.allclose(moved, extended.simulate(values, np.sin(T) + 0.4, DT), rtol=0, atol=1e-12)


def test_what_one_vessel_loses_the_next_receives():
    simulation = load_simulation("cascaded_tanks")
    u, interval = 3.0 + 2.0 * np.sin(0.03 * np.arange(300)), 4.0
    extended = prepared(simulation, u, interval, 1e-4)
    values = extended.layout.prior_means
    record = SimpleNamespace(u=u, y=u, interval=interval)
    [port] = [i for i, b in enumerate(simulation.force_ports) if b.reaction]
    told = measured_scales(extended, values, record, port)
    stopped = extended.attach(catalogue()["strain_stiffening"], told, port)
    unit = extended.normalisations[port]

    def slopes(x, v, p, dx):
        simulation.derivative(x, v, p, dx)
        flow = unit.unit_force * 0.3 * (x[0] / unit.scale) ** 3
        dx[0] -= flow
        dx[1] += flow

    found = stopped.simulate(np.concatenate([values, cubic(stopped, 0.3)]), u, interval)
    assert np.allclose(found, reference(simulation, u, interval, slopes), atol=5e-3)
    assert stopped.places.label(stopped.attached[0]) == "strain_stiffening@upper_level>lower_level"


def test_forces_on_what_nothing_pulls_back_are_measured_by_the_drive():
    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = p[0] * u

    carriage = Simulation(
        name="carriage", input_unit="V", output_unit="m",
        states=(State("position", "m", 0.0), State("velocity", "m/s", 0.0)),
        parameters=(Parameter("gain", "m/s^2/V", 3.0, 0.2),), derivative=derivative,
        output=lambda x, u, p: x[0], drive="gain",
        force_ports=(ForcePort("velocity", "position", "velocity"),),
    )  # fmt: skip
    [unit] = prepared(carriage, 0.5 * np.sin(9 * T), DT, 1e-3).normalisations
    assert unit.unit_force == pytest.approx(3.0, rel=1e-2)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"drive": "power"}, "the drive names 'power'"),
        ({"equation": "speed"}, "force port names 'speed'"),
        ({"slope": "p[0] * (u - x[0]) / x[0]"}, "derivative of level is not a number"),
        ({"slope": "p[0] * u - x[1]"}, "a state or parameter that is not declared"),
        ({"slope": "undefined_name"}, "numba cannot compile it: 'undefined_name' is not defined"),
        ({"slope": "p[0] * (x + 'a')"}, "numba cannot compile it, line 6: No implementation of"),
        ({"slope": "1 +"}, "cannot be run"),
    ],
)
def test_a_users_simulation_is_checked(tmp_path, changed, message):
    path = write_own(tmp_path / "own.py", **changed)
    with pytest.raises(InputError, match=message) as error:
        load_simulation(path)
    assert error.value.file == path
    assert error.value.remedy


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"derivative": lambda x, u, p: x[0]},
            r"derivative: it takes 3 arguments\. Give a function derivative\(x, u, p, dx\)",
        ),
        (
            {"output": lambda x: x[0]},
            r"output: it takes 1 argument\. Give a function output\(x, u, p\)",
        ),
        ({"derivative": None}, r"derivative: it is NoneType, no function\. Give a function"),
        ({"output": 1.0}, r"output: it is float, no function\. Give a function"),
    ],
)
def test_equations_are_functions_of_the_arguments_that_they_get(changed, message):
    own = load_simulation("mass_spring_damper")
    with pytest.raises(InputError, match=message):
        replace(own, **changed)


def test_the_equation_of_a_file_that_takes_other_arguments_is_named(tmp_path):
    path = write_own(tmp_path / "own.py")
    path.write_text(path.read_text().replace("output(x, u, p)", "output(x, u)"))
    with pytest.raises(InputError, match=r"own\.py: output: it takes 2 arguments"):
        load_simulation(path)


@pytest.mark.parametrize(
    ("port", "message"),
    [
        (
            ForcePort("upper_level", "upper_level", None, divisor="mass"),
            "names 'mass', which is no",
        ),
        (
            ForcePort(
                "upper_level", "upper_level", None, reaction="lower_level", divisor="lower_inflow"
            ),
            "a divisor and a reaction",
        ),
    ],
)
def test_the_divisor_of_a_force_port_is_checked(port, message):
    with pytest.raises(InputError, match=message):
        replace(load_simulation("cascaded_tanks"), force_ports=(port,))


@pytest.mark.parametrize(
    ("kind", "found"),
    [
        ("place", (2.0, 5.0, "rad")),
        ("length", (0.0, 5.0, "rad")),
        ("rate", (0.0, 5.0, "rad/s")),
        ("force", (0.0, 40.0, "rad/s^2")),
        ("stiffness", (0.0, 8.0, "1/s^2")),
        ("", (0.0, 1.0, "A")),
    ],
)
def test_a_force_law_is_told_in_the_units_of_its_port(kind, found):
    own = load_simulation("mass_spring_damper")
    units = {"position": "rad", "velocity": "rad/s"}
    own = replace(own, states=tuple(replace(each, unit=units[each.name]) for each in own.states))
    port = Normalisation(rest=2.0, scale=5.0, unit_force=40.0)
    extended = ExtendedSimulation(own, normalisations=(port,))
    attached = Attached(catalogue()["coulomb_friction"], SCALES)
    parameter = Parameter("any", "A", 1.0, 1.0, at_port=kind)
    assert extended.places.own_unit(attached, parameter) == found


def test_a_divisor_takes_part_in_the_unit_of_a_force():
    """The film's forces are stresses: its equation divides them by a viscosity."""
    own = load_simulation("dea_film")
    extended = ExtendedSimulation(own, normalisations=(Normalisation(1.0, 0.2, 600.0),))
    attached = Attached(catalogue()["viscoelastic_creep"], SCALES)
    [stiffness, *_] = attached.parameters
    assert extended.places.own_unit(attached, stiffness) == (0.0, pytest.approx(3000.0), "Pa")


def test_without_a_position_lengths_are_in_the_unit_of_the_integrated_velocity():
    own = load_simulation("electric_drive")
    extended = ExtendedSimulation(own, normalisations=(Normalisation(scale=5.0, unit_force=40.0),))
    attached = Attached(catalogue()["coulomb_friction"], SCALES)
    units = {"length": "ticks", "rate": "ticks/s", "force": "ticks/s^2"}
    sizes = {"length": 5.0, "rate": 5.0, "force": 40.0}
    for kind, unit in units.items():
        parameter = Parameter("any", "A", 1.0, 1.0, at_port=kind)
        assert extended.places.own_unit(attached, parameter) == (0.0, sizes[kind], unit)


def test_without_a_force_a_law_is_in_units_of_its_port():
    own = load_simulation("mass_spring_damper")
    extended = ExtendedSimulation(own, normalisations=(Normalisation(scale=5.0),))
    attached = Attached(catalogue()["coulomb_friction"], SCALES)
    for kind in ("force", "stiffness"):
        parameter = Parameter("any", "A", 1.0, 1.0, at_port=kind)
        assert extended.places.own_unit(attached, parameter) == (0.0, 1.0, "A")


@pytest.mark.slow
def test_what_numba_keeps_of_a_users_simulation_is_found_again(tmp_path):
    path = write_own(tmp_path / "own.py", slope="p[0] * less(p[1] * u, x[0])")
    text = "from numba import njit\n\n\ndef less(a, b):\n    return a - b\n" + path.read_text()
    path.write_text(text.replace("def ", "@njit(cache=True)\ndef "))
    load = f"from dea.simulation import load_simulation; load_simulation({str(path)!r})"
    for _ in range(2):
        run = subprocess.run([sys.executable, "-c", load], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr


def test_a_file_without_a_simulation_is_named(tmp_path):
    path = tmp_path / "own.py"
    path.write_text("x = 1\n")
    with pytest.raises(InputError, match=r"own.py.*defines no `simulation`"):
        load_simulation(path)
    with pytest.raises(InputError, match="no simulation 'nothing'"):
        load_simulation("nothing")
    with pytest.raises(InputError, match=r"no file 'nothing\.py'"):
        load_simulation("nothing.py")


def test_names_are_unique():
    with pytest.raises(InputError, match="two states or parameters are called 'x'"):
        Simulation(
            name="twice", input_unit="V", output_unit="V", states=(State("x", "V", 0.0),),
            parameters=(Parameter("x", "1", 1.0, 0.0),), derivative=None, output=None, drive="x",
            force_ports=(ForcePort("x", "x", None),),
        )  # fmt: skip


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            {"parameters": (Parameter("output_gain", "1", 1.0, 0.1),), "drive": "output_gain"},
            "output_gain.*is a name that the library gives",
        ),
        (
            {"parameters": (Parameter("initial.x", "1", 1.0, 0.1),), "drive": "initial.x"},
            "without a point",
        ),
        (
            {"force_ports": (ForcePort("x", "x", None), ForcePort("x", "x", "x"))},
            "two force ports are called 'x'",
        ),
        (
            {"states": (State("a+b", "V", 0.0),), "force_ports": ()},
            r"states: the name 'a\+b' holds",
        ),
    ],
)
def test_no_name_is_one_that_the_library_gives(change, told):
    """Values are saved by name, and effects are told apart by that of their port."""
    settings = {
        "name": "one", "input_unit": "V", "output_unit": "V", "states": (State("x", "V", 0.0),),
        "parameters": (Parameter("gain", "1", 1.0, 0.0),), "derivative": None, "output": None,
        "drive": "gain", "force_ports": (),
    }  # fmt: skip
    with pytest.raises(InputError, match=told):
        Simulation(**settings | change)


def test_nothing_free_has_no_bounds():
    own = load_simulation("mass_spring_damper")
    known = tuple(replace(each, spread=0.0) for each in own.parameters)
    states = tuple(replace(each, spread=0.0) for each in own.states)
    fixed = replace(
        own, parameters=known, states=states, output_offset_spread=0.0, output_gain_spread=0.0,
        input_offset_spread=0.0,
    )  # fmt: skip
    low, high = ExtendedSimulation(fixed).layout.bounds
    assert low.shape == high.shape == (0,)


def test_a_file_that_is_changed_in_memory_is_not_saved_as_that_file(tmp_path):
    path = write_simulation(tmp_path / "own.py")
    own = load_simulation(path)
    extended = prepared(own, np.ones(100), DT, 1e-3)
    save_extended(
        extended,
        extended.layout.prior_means,
        DT,
        tmp_path / "a.yaml",
    )
    assert load_extended(tmp_path / "a.yaml")[0].simulation.source == str(path)
    linear = replace(extended, simulation=own.interpolated("linear"))
    save_extended(linear, extended.layout.prior_means, DT, tmp_path / "a.yaml")
    again = load_extended(tmp_path / "a.yaml")[0].simulation
    assert (again.source, again.input_interpolation) == (str(path), "linear")
    filtered = replace(extended, simulation=replace(own, sensor_filter=SensorFilter(2.0)))
    values = filtered.layout.prior_means
    with pytest.raises(InputError, match="made or changed in memory"):
        save_extended(filtered, values, DT, tmp_path / "b.yaml")


@pytest.mark.parametrize("written", ["5e0", "null", "true", "'1.0'"])
def test_a_saved_value_that_is_no_number_is_named(tmp_path, written):
    extended = prepared(load_simulation("mass_spring_damper"), np.ones(100), DT, 1e-3)
    path = tmp_path / "extended.yaml"
    save_extended(extended, extended.layout.prior_means, DT, path)
    saved = yaml.safe_load(path.read_text())
    name = extended.layout.names[0]
    value = f"value: {saved['parameters'][name]['value']}"
    path.write_text(path.read_text().replace(value, f"value: {written}", 1))
    with pytest.raises(InputError, match=rf"extended.yaml: parameters.{name}.value: it is"):
        load_extended(path)


@pytest.mark.parametrize("order", [("position", "velocity"), ("velocity", "position")])
def test_a_second_mass_moves_as_its_equations_wherever_the_states_stand(order):
    """Two masses by another integrator; the place and speed of the second are kept by the law."""
    place, speed = order.index("position"), order.index("velocity")
    own = load_simulation("mass_spring_damper")
    omega, zeta = 2 * pi * 2.0, 0.2

    def derivative(x, u, p, dx):
        dx[place] = x[speed]
        dx[speed] = omega * omega * (p[0] * u - x[place]) - 2.0 * zeta * omega * x[speed]

    simulation = replace(
        own, name="carriage", states=tuple(State(name, "V", 0.0) for name in order),
        parameters=(own.parameters[2],), derivative=derivative,
        output=lambda x, u, p: x[place], input_interpolation="zero",
    )  # fmt: skip
    u = np.sin(2 * np.pi * 0.7 * T)
    extended = replace(prepared(simulation, u, DT, 1e-5), substeps=32)
    values = extended.layout.prior_means
    scales = measured_scales(extended, values, SimpleNamespace(u=u, y=u, interval=DT))
    extended = extended.attach(catalogue()["second_mode"], scales)
    unit = extended.normalisations[0]
    coupling, own_omega, damping = 0.6, 2 * pi * 1.3, 0.1
    law = [coupling, 1.3, damping, 0.0, 0.0, 0.0, 0.0, 0.0]

    def slope(_, x, v):
        z, w = (x[0] - unit.rest) / unit.scale, x[1] / unit.scale
        stretch = z - x[2] + 2.0 * damping / own_omega * (w - x[3])
        first = omega**2 * (v - x[0]) - 2.0 * zeta * omega * x[1]
        return [x[1], first - unit.unit_force * coupling * stretch, x[3], own_omega**2 * stretch]

    x, expected = np.zeros(4), []
    for v in u:
        expected.append(x[0])
        x = solve_ivp(slope, (0, DT), x, args=(v,), rtol=1e-9, atol=1e-12).y[:, -1]
    found = extended.simulate(np.concatenate([values, law]), u, DT)
    np.testing.assert_allclose(found, expected, atol=2e-3 * np.ptp(expected))


@pytest.mark.parametrize("apart", [0.0, 0.4])
def test_a_second_mass_on_a_drive_that_nothing_pulls_back_is_coupled_by_its_inertia(apart):
    """The drive turns already, far from zero, and so does what is coupled to it."""
    own = load_simulation("mass_spring_damper")
    inertia, loss, ratio, omega, damping = 0.02, 2.5, 0.75, 2 * pi * 1.3, 0.1

    def derivative(x, u, p, dx):
        dx[0] = x[1]
        dx[1] = u / inertia - loss * x[1]

    simulation = replace(
        own, name="drive", states=(State("angle", "V", 7.0), State("speed", "V/s", 5.0)),
        parameters=(own.parameters[2],), derivative=derivative,
        output=lambda x, u, p: x[1], input_interpolation="zero",
        force_ports=(ForcePort("speed", "angle", "speed"),),
    )  # fmt: skip
    u = np.repeat(np.random.default_rng(8).uniform(-1.0, 1.0, T.size // 25 + 1), 25)[: T.size]
    extended = replace(prepared(simulation, u, DT, 1e-5), substeps=32)
    values = extended.layout.prior_means
    scales = measured_scales(extended, values, SimpleNamespace(u=u, y=u, interval=DT))
    extended = extended.attach(catalogue()["second_mode"], scales)
    law = {p.name: p.nominal for p in catalogue()["second_mode"].parameters(scales)}
    law |= {"coupling": ratio, "frequency": omega / 2 / pi, "damping_ratio": damping}
    [unit] = extended.normalisations
    law["start_position"] = apart * unit.inertia * omega**2 / unit.scale

    def slope(_, x, v):
        pull = omega**2 * (x[0] - x[2]) + 2.0 * damping * omega * (x[1] - x[3])
        return [x[1], v / inertia - loss * x[1] - ratio * pull, x[3], pull]

    x, expected = np.array([7.0, 5.0, 7.0 + apart, 5.0]), []
    for v in u:
        expected.append(x[1])
        x = solve_ivp(slope, (0, DT), x, args=(v,), rtol=1e-9, atol=1e-12).y[:, -1]
    found = extended.simulate(np.concatenate([values, list(law.values())]), u, DT)
    np.testing.assert_allclose(found, expected, atol=3e-3 * np.ptp(expected))


@pytest.mark.parametrize(
    ("device", "start", "bias", "places"),
    [
        ("mass_spring_damper", "position", 0.0, (0, 0)),
        ("mass_spring_damper", "position", 0.0, (0, 0, 0)),
        ("cascaded_tanks", "upper_level", 3.0, (0, 2)),
        ("cascaded_tanks", "upper_level", 3.0, (0, 2, 1)),
    ],
)
def test_forces_add_up_whatever_their_order(device, start, bias, places):
    """Each of them remembers something, so that the memories must be kept apart."""
    u = bias + np.sin(2 * np.pi * 0.7 * T) + 0.3 * np.sin(2 * np.pi * 1.9 * T)
    plain = prepared(load_simulation(device), u, DT, 1e-4)
    own = plain.layout.prior_means
    own[plain.layout.names.index(f"initial.{start}")] = 0.7 + bias  # memories begin away from rest
    record = SimpleNamespace(u=u, y=u, interval=DT)
    names = "viscoelastic_creep", "rate_independent_hysteresis", "cyclic_softening"
    runs = []
    for order in permutations(zip(names, places, strict=False)):
        extended = plain
        for name, place in order:
            scales = measured_scales(plain, own, record, place)
            extended = extended.attach(catalogue()[name], scales, place)
        laws = [a.started(a.effect.starts(a.scales)[0]) for a in extended.attached]
        runs.append(extended.simulate(np.concatenate([own, *laws]), u, DT))
    assert np.ptp(runs[0] - plain.simulate(own, u, DT)) > 1e-3 * np.ptp(runs[0])
    for run in runs[1:]:
        np.testing.assert_allclose(run, runs[0], atol=1e-6 * np.ptp(runs[0]))


@pytest.mark.parametrize(
    "slope",
    ["1 / p[0] / x[0]", "1.0 / (x[0] - x[0])", "(x[0] - 1) ** 0.5", "1 / float(x[0])"],
)
def test_an_index_of_the_output_is_checked_beside_a_slope_that_python_refuses(tmp_path, slope):
    path = write_own(tmp_path / "own.py", slope=slope)
    path.write_text(path.read_text().replace("return x[0]", "return x[1]"))
    with pytest.raises(InputError, match=r"output: .*not declared"):
        load_simulation(path)


def test_what_numba_says_in_one_line_leaves_the_problem_as_it_is(tmp_path):
    error = InputError("it cannot be compiled", field="derivative", remedy="Simplify it")
    error.__cause__ = NumbaError("out of memory")
    explained = _explained(error, tmp_path / "own.py")
    assert explained.problem == "it cannot be compiled"
    assert (explained.file, explained.field) == (tmp_path / "own.py", "derivative")


@pytest.mark.parametrize("change", [{"name": "mine"}, {"sensor_filter": SensorFilter(40.0)}])
def test_a_simulation_that_could_not_be_loaded_is_not_saved(tmp_path, change):
    own = replace(load_simulation("mass_spring_damper"), **change)
    extended = prepared(own, np.sin(np.arange(200) * DT), DT, 1e-6)
    path = tmp_path / "extended.yaml"
    with pytest.raises(InputError, match="made or changed in memory"):
        save_extended(extended, extended.layout.prior_means, DT, path)
    assert not path.exists()


@pytest.mark.parametrize("effect", ["coulomb_friction", "rate_independent_hysteresis"])
def test_a_memory_of_the_motion_begins_with_the_record(effect):
    """The same record after lead-ins that come from below and from above."""
    u = 2.4 + np.cos(2 * np.pi * 0.5 * T)
    plain = prepared(load_simulation("dea_membrane"), u, DT, 1e-3)
    own, found = replace(plain.simulation, lead_in=6.0), []
    for start in (0.02, 0.15):
        states = [replace(s, initial=start) if s.name == "position" else s for s in own.states]
        extended = replace(plain, simulation=replace(own, states=tuple(states)))
        extended = extended.attach(catalogue()[effect], SCALES)
        found.append(extended.simulate(extended.layout.prior_means, u, DT))
    np.testing.assert_allclose(found[0][:40], found[1][:40], rtol=1e-5)


def test_friction_holds_the_device_before_the_record_as_well():
    plain = prepared(load_simulation("dea_membrane"), 2.4 + np.cos(3 * T), DT, 1e-3)
    u = np.full(T.size, 2.4)
    free = plain.simulate(plain.layout.prior_means, u, DT)
    extended = plain.attach(catalogue()["coulomb_friction"], SCALES)
    values = extended.layout.prior_means
    values[extended.layout.names.index("coulomb_friction.start_deflection")] = 1.0
    held = extended.simulate(values, u, DT)
    assert np.ptp(held) < 1e-6 * held[0]
    assert held[0] < free[0] - 1e-3 * free[0]


@pytest.mark.parametrize("name", ["backlash", "step_fault"])
def test_what_is_said_to_change_the_reading_alone_leaves_the_motion_as_it_is(name):
    u = np.random.default_rng(1).uniform(-1.0, 1.0, 400)
    extended = prepared(load_simulation("mass_spring_damper"), u, 0.02, 1e-4)
    values = extended.layout.prior_means
    scales = measured_scales(extended, values, SimpleNamespace(u=u, y=u, interval=0.02))
    extended = extended.attach(catalogue()[name], scales)
    x = np.full(extended.layout.free.size, 0.1)
    before = extended.run(extended.layout.values(x), u, 0.02)
    alike = []
    for index in range(x.size):
        moved = x.copy()
        moved[index] += 0.1
        alike.append(np.array_equal(extended.run(extended.layout.values(moved), u, 0.02), before))
    marked = [p.reads for p in extended.attached[0].parameters if p.spread > 0.0]
    assert any(marked)
    assert not all(marked)
    own = np.asarray(alike)[-len(marked) :]
    np.testing.assert_array_equal(own[marked], True)
    np.testing.assert_array_equal(extended.layout.only_read[-len(marked) :], marked)
