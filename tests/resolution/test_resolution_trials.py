"""The campaign of ambiguous trials: its source of records, and what its table counts."""

import json

import numpy as np
import pandas as pd
import pytest

from benchmarks.resolution import BENCH, FIRST, Film, kept, table, violated
from dea.plant import Use, draw_trial
from dea.resolution import CERTIFICATE, Limits
from dea.store import Record


def test_a_trial_answers_every_excitation_from_rest_with_noise_of_its_own():
    trial = draw_trial(BENCH, 1, 0, Use.TUNING, ambiguous=True)
    u = np.full(400, 2.0)
    film = Film(trial)
    first, second = (film.record(number, u) for number in (FIRST, CERTIFICATE))
    assert first.sampling_rate == trial.sampling_rate
    assert not np.array_equal(first.y, second.y)
    assert film.driven == [first, second]
    truth = trial.readings(BENCH, u)[1]
    for record in (first, second):
        assert np.std(record.y - truth) == pytest.approx(
            trial.kind.scale * trial.noise.rms, rel=0.2
        )


def test_a_limit_is_violated_by_an_input_or_by_a_measured_output():
    limits = Limits(0.0, 1.0, 5.0, -1.0, 1.0, 10.0)

    def found(u, y):
        return violated(Record.of(np.array(u), np.array(y), 10.0, units=("V", "mm")), limits)

    assert not found([0.0, 0.5, 1.0], [-1.0, 0.0, 1.0])
    assert found([0.0, 0.6, 1.0], [0.0, 0.0, 0.0])
    assert found([0.0, 0.5, 1.01], [0.0, 0.0, 0.0])
    assert found([0.0, 0.5, 1.0], [0.0, 0.0, 1.1])


def test_outcomes_of_the_same_code_and_settings_alone_are_taken_up(tmp_path):
    file = tmp_path / "outcomes.jsonl"
    assert kept(file, "abc", "s") == {}
    rows = [
        {"trial": "1", "forms": "free", "commit": commit, "settings": settings}
        for commit, settings in (("abc", "s"), ("abc", "other"), ("def", "s"), ("abc-dirty", "s"))
    ]
    file.write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert kept(file, "abc", "s") == {("1", "free"): rows[0]}
    assert kept(file, "abc-dirty", "s") == {}


def test_only_trials_that_a_first_record_leaves_open_are_counted():
    row = {"forms": "free", "right": True, "wrong": False, "left open": True, "seconds": 30.0}
    rows = [
        row,
        row | {"right": False, "wrong": True, "seconds": 60.0},
        row | {"right": False, "seconds": 90.0},
        row | {"left open": False, "seconds": 0.0},
        row | {"forms": "fixed", "seconds": 120.0},
    ]
    found = table(pd.DataFrame([each | {"limit violated": False} for each in rows]))
    free, fixed = found.to_dict("records")
    assert (free["trials"], free["right"], free["wrong"], free["without a name"]) == (3, 1, 1, 1)
    assert free["median seconds driven"] == pytest.approx(60.0)
    assert fixed["trials"] == fixed["right"] == 1
