"""The campaign on drawn actuators counts what happened and sees a violated limit."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.control_robustness import (
    SCENARIOS,
    Outcome,
    drawn,
    table,
    tried,
)

from dea.control import ControllerDesign, LostError, RunIn, Task
from dea.narx import NarxModel, Scaling
from dea.terms import Term

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


def test_actuators_are_drawn_alike_each_time_and_differ():
    first, again, other = drawn("dea2", 3, 1), drawn("dea2", 3, 1), drawn("dea2", 4, 1)
    assert first.film.yeoh_1 == again.film.yeoh_1 != other.film.yeoh_1
    assert first.film.branch_modulus[0] / other.film.branch_modulus[0] == pytest.approx(
        first.film.yeoh_1 / other.film.yeoh_1
    )
