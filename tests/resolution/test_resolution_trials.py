"""The campaign of ambiguous trials: its desk, and what its table counts."""

import numpy as np
import pandas as pd
import pytest
from benchmarks.resolution import BENCH, Film, table

from dea.plant import Use, draw_trial


def test_a_trial_answers_every_excitation_from_rest_with_noise_of_its_own():
    trial = draw_trial(BENCH, 1, 0, Use.TUNING, ambiguous=True)
    u = np.full(400, 2.0)
    first, second = (Film(trial).record(number, u) for number in (1, 2))
    assert first.sampling_rate == trial.sampling_rate
    assert not np.array_equal(first.y, second.y)
    truth = trial.readings(BENCH, u)[1]
    assert np.std(first.y - truth) < 0.2 * max(np.ptp(truth), 1.0)


def test_only_trials_that_a_first_record_leaves_open_are_counted():
    row = {"forms": "free", "right": True, "wrong": False, "records": 1, "seconds": 30.0}
    rows = [
        row,
        row | {"right": False, "wrong": True, "seconds": 60.0},
        row | {"right": False, "records": 2, "seconds": 90.0},
        row | {"records": 0, "seconds": 0.0},
        row | {"forms": "fixed", "seconds": 120.0},
    ]
    found = table(pd.DataFrame([each | {"limit violated": False} for each in rows]))
    free, fixed = found.to_dict("records")
    assert (free["trials"], free["right"], free["wrong"], free["without a name"]) == (3, 1, 1, 1)
    assert free["median seconds driven"] == pytest.approx(60.0)
    assert fixed["trials"] == fixed["right"] == 1
