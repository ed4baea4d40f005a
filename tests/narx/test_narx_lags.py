"""Lags chosen by held-out errors: the right ones win, and no unstable model does."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.io import loadmat

from dea.errors import InputError
from dea.narx import NarxModel, held_out_error, lag_choices, select_lags
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
def test_the_lags_of_a_drive_are_those_found_and_better_than_others(number):
    case = yaml.safe_load((CASES / f"coupled_drives_{number}.yaml").read_text())["identification"]
    record = loadmat(DATA / "coupled_drives" / "drive.mat")
    u, y = (record[f"{name}{number}"].ravel()[:300].astype(float) for name in ("u", "z"))
    own = tuple(range(1, case["y_lags"] + 1)), tuple(case["u_lags"])
    offered = lag_choices(y, even_in_input=True)
    assert own in offered
    others = [each for each in offered if each.u_lags[-1] > own[1][-1]][-3:]
    found = select_lags(u, y, [own, *others], even_in_input=True)
    assert found[0].lags == own
