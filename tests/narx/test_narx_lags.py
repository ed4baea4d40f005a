"""Lags chosen by held-out errors: the right ones win, and no unstable model does."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.io import loadmat

from dea.errors import InputError
from dea.narx import NarxModel, held_out_error, lag_choices, select_lags, select_terms
from dea.progress import heard_by
from dea.store import Record
from measured_records import DATA, needs_records

CASES = Path(__file__).parents[2] / "config" / "cases"
# Only lag 3 of the input acts, and lag 2 of the output.
PLANT = NarxModel.from_terms({"y(t-2)": 0.6, "u(t-3)": 0.5, "u(t-3)^2": 0.3})


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(2)
    u = rng.uniform(-1.0, 1.0, 500)
    return u, PLANT.simulate(u) + 0.01 * rng.standard_normal(u.size)


def test_the_choice_with_the_plants_lags_has_the_least_error(record):
    choices = [(1, 1), ([2], [3]), (1, [1, 2]), ([1, 2], [4])]
    found = select_lags(*record, choices, degree=2, cuts=(2, 3))
    assert found[0].lags == ((2,), (3,))
    assert set(found[0].model.terms) >= set(PLANT.terms)
    assert found[0].error == pytest.approx(0.01, rel=0.15)
    assert [each.error for each in found] == sorted(each.error for each in found)
    # All runs start after lag 4, the longest of all choices.
    parts = [held_out_error(found[0].model, *record, parts=n, start=4) for n in (2, 3)]
    assert found[0].error == pytest.approx(np.sqrt(np.prod(parts)))


def test_models_of_a_record_carry_its_rate_units_and_names(record):
    whole = Record.of(*record, 50.0, units=("V", "mm"), names=("command", "place"))
    found = select_lags(whole, choices=[(2, 3)], degree=2, cuts=(2,))
    model = select_terms(whole, y_lags=2, u_lags=3, degree=2)
    assert found[0].model.labels == model.labels
    assert found[0].model.labels.u_units == "V"
    assert found[0].model.terms == model.terms


def test_a_choice_that_gives_no_model_is_left_out(record):
    told = []
    with heard_by(told.append):
        found = select_lags(*record, [([2], [400]), ([2], [3]), ([], [])], degree=2, cuts=(2,))
    assert {each.lags for each in found} == {((2,), (3,)), ((), ())}
    assert "lags (2,) and (400,) are left out: parts: 2 parts of 500 samples" in told[0]
    # Nor does its lag put off where the runs of others start.
    error = held_out_error(found[0].model, *record, parts=2, start=3)
    assert found[0].error == pytest.approx(error, rel=1e-12)
    with pytest.raises(InputError, match="parts: 2 parts of 500 samples"):
        select_lags(*record, [([2], [400])], cuts=(2,))


def test_a_search_that_is_refused_loses_its_choice_alone(record, monkeypatch):
    def search(*args, y_lags, **settings):
        if y_lags == (1,):
            raise InputError("no run is bounded", field="u")
        return select_terms(*args, y_lags=y_lags, **settings)

    monkeypatch.setattr("dea.narx.lags.select_terms", search)
    found = select_lags(*record, [(1, 1), ([2], [3])], degree=2, cuts=(2,))
    assert [each.lags for each in found] == [((2,), (3,))]
    with pytest.raises(InputError, match="u: no run is bounded"):
        select_lags(*record, [(1, 1)], cuts=(2,))


def test_every_input_may_have_its_own_lags(record):
    u = np.column_stack([record[0], np.random.default_rng(3).uniform(-1.0, 1.0, 500)])
    choices = [([2], [[3], [1, 2]]), ([2], [[3], [3]]), ([2], [4])]
    found = select_lags(u, record[1], choices, degree=2, cuts=(2,))
    assert {each.lags.u_lags for each in found} == {((3,), (1, 2)), (3,), (4,)}
    assert found[-1].lags.u_lags == (4,)


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ((1, [[1], [2]]), "u_lags: .* for 1 input"),
        (([[1]], 1), "y_lags: .* whole numbers"),
        ((1, [1.5]), "u_lags: .* whole numbers"),
    ],
)
def test_lags_that_are_none_are_refused(record, choice, words):
    with pytest.raises(InputError, match=words):
        select_lags(*record, [choice])


def test_each_threshold_is_tried(record):
    found = select_lags(*record, [([2], [3])], degree=2, thresholds=(None, 0.05), cuts=(2,))
    assert {each.threshold for each in found} == {None, 0.05}
    few = next(each for each in found if each.threshold == 0.05)
    assert len(few.model.terms) < len(PLANT.terms)


def test_choices_are_spaced_up_to_a_fifth_of_the_time_until_the_autocorrelation_is_least():
    t = np.arange(1000)
    y = np.cos(2 * np.pi * t / 80)  # least after 40 samples; its square, of half the period, 20
    spacings = {lags.y_lags[1] - 1 for lags in lag_choices(y)}
    assert spacings == {1, 2, 3, 4}
    assert all(lags.y_lags == lags.u_lags for lags in lag_choices(y))
    even = lag_choices(y, even_in_input=True)
    assert {lags.u_lags[-1] // 10 for lags in even} <= {7, 8, 11, 12, 15, 16, 19, 20}
    assert {lags.y_lags for lags in even} == {(1, 2), (1, 2, 3), (1, 2, 3, 4)}


def test_lags_are_no_longer_than_a_tenth_of_a_record():
    y = np.cos(2 * np.pi * np.arange(200) / 80)
    for even in (False, True):
        longest = {max(each.y_lags + each.u_lags) for each in lag_choices(y, even_in_input=even)}
        assert max(longest) <= 20
    assert lag_choices(y[:15]) == [((1, 2), (1, 2))]


def test_outputs_with_gaps_are_refused():
    with pytest.raises(InputError, match="y: 1 of 50 samples are not numbers"):
        lag_choices(np.where(np.arange(50) == 7, np.nan, np.arange(50.0)))


def test_white_outputs_have_neighbouring_lags_alone():
    y = np.random.default_rng(0).standard_normal(400)
    assert {lags.y_lags for lags in lag_choices(y)} == {(1, 2), (1, 2, 3)}


def test_nothing_to_choose_from_is_refused(record):
    with pytest.raises(InputError, match="choices, thresholds, cuts: there is nothing"):
        select_lags(*record, [])


def test_runs_that_start_before_the_lags_are_refused(record):
    with pytest.raises(InputError, match="start: it is 2, and the model's largest lag 3"):
        held_out_error(PLANT, *record, parts=3, start=2)


@needs_records
@pytest.mark.parametrize("number", [1, 2])
def test_the_input_lags_of_a_drive_beat_other_reaches_and_the_lags_between(number):
    case = yaml.safe_load((CASES / f"coupled_drives_{number}.yaml").read_text())["identification"]
    record = loadmat(DATA / "coupled_drives" / "drive.mat")
    u, y = (record[f"{name}{number}"].ravel()[:300].astype(float) for name in ("u", "z"))
    own = tuple(range(1, case["y_lags"] + 1)), tuple(case["u_lags"])
    offered = lag_choices(y, even_in_input=True)
    assert own in offered
    alike = [
        each for each in offered if each.y_lags == own[0] and each.u_lags[1] - each.u_lags[0] == 2
    ]
    found = select_lags(u, y, alike, even_in_input=True)
    assert len(found) == 8  # four reaches, from the first lag on and from the second
    assert found[0].lags == own
