"""The campaign on drawn actuators counts what happened and sees a violated limit."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import control_robustness
from benchmarks.control_robustness import (
    AGED,
    LOAD,
    SCENARIOS,
    Outcome,
    aged,
    drawn,
    table,
    tried,
)
from dea.control import ControllerDesign, LostError, RunIn, Task
from dea.narx import NarxModel, Scaling
from dea.terms import Term

ACTUATORS = [f"dea{k}" for k in range(1, 7)]
TASK = Task(np.full(60, 0.9), 0.2, 2.0, RunIn(5, 5), (1.5, 3.0))
MODEL = NarxModel((Term.parse("y(t-1)"),), np.array([0.5]), Scaling(2.0, 1.0, 0.9, 0.1))
TRIAL = ControllerDesign(MODEL, np.ones(2), TASK, [], {"rate": 10.0}, 50.0)


class Playing:
    """Gives voltages whatever it measures, and stops where they end."""

    def __init__(self, volts):
        self.volts, self.measured, self.reference = iter(volts), [], TASK.reference

    def __call__(self, measured):
        self.measured.append(measured)
        for volts in self.volts:
            return volts
        raise LostError("no more voltages")


def test_a_row_counts_every_outcome():
    outcomes = [("undisturbed", Outcome(0.01, False, "")), ("undisturbed", Outcome(0.2, True, "")),
                ("undisturbed", Outcome(np.nan, False, "it hung"))]  # fmt: skip
    row = table(outcomes).set_index("scenario").loc["undisturbed"]
    counts = row[["actuators", "followed", "off", "stopped", "limit violated"]]
    assert counts.tolist() == [3, 1, 1, 1, 1]
    assert row["median error (%)"] == pytest.approx(10.5)


@pytest.mark.parametrize(
    ("volts", "violated"),
    [([2.0] * 60, False), ([2.0, 2.1, 2.3], False), ([2.0, 2.3], True), ([2.0] * 9 + [1.4], True)],
)
def test_a_violated_limit_or_rate_is_seen(volts, violated):
    outcome = tried(drawn("dea1", 1, 1), TRIAL, Playing(volts), SCENARIOS["undisturbed"], 1)
    assert outcome.violated is violated
    assert bool(outcome.stopped) is (len(volts) < 60)


def test_a_voltage_that_is_no_number_violates_a_limit():
    assert control_robustness.violated([2.0, 2.1], TRIAL) is False
    assert control_robustness.violated([2.0, np.nan, 2.0], TRIAL) is True
    assert control_robustness.violated([2.0, np.nan], TRIAL) is True


def test_an_error_that_is_no_number_is_off():
    row = table([("undisturbed", Outcome(np.nan, False, ""))]).iloc[0]
    assert row[["followed", "off", "stopped"]].tolist() == [0, 1, 0]


def test_a_late_sample_and_a_dropped_sensor_reach_the_controller():
    task = replace(TASK, reference=np.full(700, 0.9))
    design = replace(TRIAL, task=task)
    steps = np.where(np.arange(700) < 600, 2.0, 2.1)
    found = {}
    for name in ("undisturbed", "sensor dropped for a second", "late sample"):
        playing = Playing(steps)
        playing.reference = task.reference
        tried(drawn("dea1", 1, 1), design, playing, SCENARIOS[name], 1)
        found[name] = np.array(playing.measured)
    dropped = np.isnan(found["sensor dropped for a second"])
    assert np.flatnonzero(dropped).tolist() == list(range(500, 550))
    # Five periods more have passed: the film has moved further.
    assert found["late sample"][601] > found["undisturbed"][601] + 5e-3
    assert np.array_equal(found["late sample"][:600], found["undisturbed"][:600])


def played(name, volts, samples=700):
    task = replace(TASK, reference=np.full(samples, 0.9))
    playing = Playing(volts)
    playing.reference = task.reference
    outcome = tried(drawn("dea1", 1, 1), replace(TRIAL, task=task), playing, SCENARIOS[name], 1)
    return outcome, np.array(playing.measured)


def test_the_second_without_a_sensor_is_scored_as_the_film_moves():
    samples = np.arange(700)
    astray = np.where((samples >= 500) & (samples < 550), 3.0, 2.0)
    seen, _ = played("undisturbed", astray)
    unseen, measured = played("sensor dropped for a second", astray)
    assert np.isnan(measured).sum() == 50
    assert unseen.error == seen.error
    steady, _ = played("undisturbed", np.full(700, 2.0))
    assert abs(seen.error - steady.error) > 0.01


def test_a_load_moves_the_output_that_is_seen_and_scored():
    steady = np.full(1000, 2.0)
    (free, before), (pushed, after) = (
        played(name, steady, 1000) for name in ("undisturbed", "step disturbances")
    )
    moved = np.flatnonzero(after - before > 0.5 * LOAD * TASK.stroke)
    assert moved.tolist() == list(range(601, 851))
    assert np.allclose((after - before)[moved], LOAD * TASK.stroke)
    assert pushed.error != free.error


def test_an_aged_actuator_is_what_twice_the_rate_makes_of_it_in_that_time():
    young = replace(
        drawn("dea1", 1, 1),
        film=drawn("dea1", 1, 1).film._replace(
            stiffness_ageing=0.15, leakage_ageing=2.0, electrode_ageing=4.0
        ),
    ).film  # fmt: skip
    old = aged(replace(drawn("dea1", 1, 1), film=young)).film
    for later in (0.0, 0.2):  # h
        age = AGED / 3600 + later
        assert (1 + old.stiffness_ageing * later) * old.yeoh_1 == pytest.approx(
            (1 + 2 * 0.15 * age) * young.yeoh_1
        )
        assert (1 + old.stiffness_ageing * later) * old.branch_modulus == pytest.approx(
            (1 + 2 * 0.15 * age) * young.branch_modulus
        )
        assert (1 + old.leakage_ageing * later) / old.leak_resistance == pytest.approx(
            (1 + 2 * 2.0 * age) / young.leak_resistance
        )
        assert (1 + old.electrode_ageing * later) * old.electrode_resistance == pytest.approx(
            (1 + 2 * 4.0 * age) * young.electrode_resistance
        )


def test_every_scenario_is_tried_on_every_actuator(monkeypatch):
    """And a foreign model follows what the actuator itself can reach."""
    tasks = {name: replace(TASK, start=2.0 + 0.01 * k) for k, name in enumerate(ACTUATORS)}
    made = []

    class Design:
        def __init__(self, name, task):
            self.name, self.task = name, task

        def gains(self):
            return f"gains of {self.name}"

        def adaptive(self, gains):
            made.append((self.name, gains, self.task))

    monkeypatch.setattr(
        control_robustness,
        "designs",
        lambda settings, names, seed: {name: Design(name, tasks[name]) for name in names},
    )
    monkeypatch.setattr(
        control_robustness, "replace", lambda design, task: Design(design.name, task)
    )
    monkeypatch.setattr(control_robustness, "drawn", lambda *which: which)
    monkeypatch.setattr(
        control_robustness,
        "tried",
        lambda parameters, design, controller, scenario, seed: (parameters, seed),
    )
    found = list(control_robustness.campaign(2, 7))
    assert [label for label, _ in found] == 2 * list(SCENARIOS)
    assert {outcome for _, outcome in found} == {
        ((ACTUATORS[0], 0, 7), 7), ((ACTUATORS[1], 1, 7), 8)
    }  # fmt: skip
    first, second = ACTUATORS[:2]
    assert made[:5] == [(first, f"gains of {first}", tasks[first])] * 5
    assert made[5] == (second, f"gains of {second}", tasks[first])


def test_actuators_are_drawn_alike_each_time_and_differ():
    first, again, other = drawn("dea2", 3, 1), drawn("dea2", 3, 1), drawn("dea2", 4, 1)
    assert first.film.yeoh_1 == again.film.yeoh_1 != other.film.yeoh_1
    assert first.film.branch_modulus[0] / other.film.branch_modulus[0] == pytest.approx(
        first.film.yeoh_1 / other.film.yeoh_1
    )
