"""Which effects a simulation or a record cannot take, and what is said of them."""

from dataclasses import replace

import numpy as np
import pytest

import two_inputs
from dea.discrepancy.budget import Budget
from dea.discrepancy.diagnose import not_offered
from dea.discrepancy.fitting.fit import fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.report.verdict import Verdict, read_verdict
from dea.discrepancy.search.not_offered import NotOffered, Obstacle, places
from dea.discrepancy.search.rounds import extend_by_each
from dea.errors import InputError
from dea.simulation import ForcePort, catalogue, load_simulation, prepared

SPRING = load_simulation("mass_spring_damper")
INTERVAL, NOISE = 0.02, 0.002
BUDGET = Budget(finished=1, first_steps=1, last_steps=1, screening=1, shakes=0)
PUSHING = {name: each for name, each in catalogue().items() if each.force is not None}


def problem_of(simulation, u):
    """A record of the simulation itself, and the simulation fitted to it."""
    extended = prepared(simulation, u, INTERVAL, 1e-4)
    values = extended.layout.prior_means
    y = extended.simulate(values, u, INTERVAL)
    y = y + NOISE * np.random.default_rng(3).standard_normal(y.size)
    parts = split(u, INTERVAL, 0.1)
    problem = Problem(u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE)
    return problem, fit(problem, extended, np.zeros(extended.layout.free.size), iterations=2)


def steps(count=1000, seed=1):
    return np.repeat(np.random.default_rng(seed).uniform(-2, 2, count // 25), 25)


def test_without_a_force_port_no_force_is_offered():
    problem, fitted = problem_of(replace(SPRING, force_ports=()), steps())
    for effect in PUSHING.values():
        free, closed = places(problem, fitted.extended, effect)
        assert free == []
        assert closed == [NotOffered(effect.name, "force balance", None, Obstacle.NO_PORT)]


def test_a_port_that_knows_a_velocity_alone_takes_friction_and_a_second_mass_and_no_spring():
    [port] = SPRING.force_ports
    blind = ForcePort(
        equation=port.equation, position=None, velocity=port.velocity, reaction=port.position
    )
    problem, fitted = problem_of(replace(SPRING, force_ports=(port, blind)), steps())
    friction, mass, stop = (
        places(problem, fitted.extended, PUSHING[name])
        for name in ("coulomb_friction", "second_mode", "end_stop")
    )
    assert friction == mass == ([0, 1], [])
    assert stop == (
        [0], [NotOffered("end_stop", "force balance", blind.name, Obstacle.NO_POSITION)],
    )  # fmt: skip


def test_an_input_that_stands_still_shows_no_effect_on_its_path():
    u = two_inputs.excitation(400)
    u[:, 1] = 0.7
    problem, fitted = problem_of(two_inputs.simulation, u)
    for name in ("dead_zone", "gain_drift"):
        kind = str(catalogue()[name].port)
        expected = [0], [NotOffered(name, kind, "right", Obstacle.STILL)]
        assert places(problem, fitted.extended, catalogue()[name]) == expected
    assert places(problem, fitted.extended, catalogue()["sensor_lag"]) == ([0], [])


@pytest.fixture(scope="module")
def round_of_singles():
    """A record of three periods, which has no frequency that the input does not have, either."""
    problem, fitted = problem_of(replace(SPRING, force_ports=()), np.tile(steps(500), 3))
    effects = catalogue()
    broken = replace(
        effects["dead_zone"], name="broken", shape_input=lambda u, q, interval: u + np.nan
    )
    offered = [effects[name] for name in ("end_stop", "periodic_disturbance", "sensor_lag")]
    return extend_by_each(problem, [fitted], [*offered, broken], BUDGET, 1)


def test_what_never_became_a_candidate_is_told_with_its_reason(round_of_singles):
    assert [c.names for c in round_of_singles.candidates] == [("sensor_lag",)]
    assert [(each.name, each.reason) for each in round_of_singles.skipped] == [
        ("end_stop", Obstacle.NO_PORT),
        ("periodic_disturbance", Obstacle.NO_START),
        ("broken", Obstacle.UNSTABLE),
    ]


def test_what_was_tried_beside_another_effect_was_tried(round_of_singles):
    offered = list(catalogue().values())
    without = replace(round_of_singles, candidates=())
    lag = NotOffered("sensor_lag", "output path", None, Obstacle.UNSTABLE)
    again = replace(without, skipped=(lag, *round_of_singles.skipped))
    assert lag in not_offered([again], offered)
    assert lag not in not_offered([again, round_of_singles], offered)


def test_what_the_settings_leave_out_is_told(round_of_singles):
    offered = [effect for name, effect in catalogue().items() if name != "dead_zone"]
    *_, last = not_offered([round_of_singles], offered)
    assert last == NotOffered("dead_zone", "input path", None, Obstacle.SETTINGS)


def test_the_list_is_written_and_read(tmp_path):
    listed = (
        NotOffered("end_stop", "force balance", "velocity", Obstacle.NO_POSITION),
        NotOffered("dead_zone", "input path", None, Obstacle.SETTINGS),
    )
    verdict = Verdict("none", "Nothing.", (), {}, 0.1, {}, "V", not_offered=listed)
    file = tmp_path / "verdict.json"
    verdict.write(file)
    assert read_verdict(file) == verdict
    assert "the force port knows a velocity alone" in file.read_text()
    written = file.read_text()
    file.write_text(written.replace("alone", "only"))
    with pytest.raises(InputError, match="no verdict"):
        read_verdict(file)
    file.write_text(written.replace('"place"', '"balance"'))
    with pytest.raises(InputError, match=r"of an earlier version .*'balance'.* Make it again"):
        read_verdict(file)
