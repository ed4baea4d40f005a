"""The table of diagnosed records says whether a published result is reached, and no more."""

import pytest

from dea.errors import InputError
from dea.tables.real_records import real_records


def verdict(status="named", after=0.3, unit="V"):
    effects = [{"name": "end_stop"}, {"name": "output_saturation"}] if status == "named" else []
    return {
        "status": status,
        "whole": True if status == "named" else None,
        "law_too_poor": False,
        "effects": effects,
        "noise_floor": 0.02,
        "unit": unit,
        "certified": {
            "rmse_before": 0.5,
            "rmse_after": 0.2,
            "records": {"other": {"before": 0.65, "after": after}},
        },
    }


GOAL = {"mine": {"other": {"before": 0.64, "after": 0.354, "units": "V"}}}


@pytest.mark.parametrize(
    ("found", "goal", "met"),
    [
        (verdict(), GOAL, True),
        (verdict(after=0.4), GOAL, False),
        (verdict("unknown"), GOAL, False),
        (verdict(), {}, None),
        (verdict("unknown"), {"mine": {"other": {"effect": "none"}}}, True),
        (verdict(), {"mine": {"other": {"effect": "none"}}}, False),
    ],
)
def test_a_result_is_met_only_by_a_name_and_its_error(found, goal, met):
    kept, row = real_records({"mine": found}, goal).exact.to_dict("records")
    assert (kept["rmse before"], kept["rmse after"], kept["met"]) == (0.5, 0.2, None)
    assert row["met"] == met if met is not None else row["met"] is None
    assert row["effects"] == " + ".join(e["name"] for e in found["effects"])
    assert (row["rmse before"], row["noise floor"]) == (0.65, 0.02)


def test_readers_see_what_is_not_there():
    shown = real_records({"mine": verdict("none")}, {}).shown.iloc[1]
    assert (shown["effects"], shown["met"], shown["published after"]) == ("–", "–", "–")


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (verdict(), "named"),
        (verdict() | {"whole": False}, "named in part"),
        (verdict() | {"law_too_poor": True}, "named, law too poor"),
        (verdict("unknown"), "unknown"),
    ],
)
def test_a_name_that_is_not_all_of_the_answer_or_not_sure_is_said_to_be(found, said):
    table = real_records({"mine": found}, {})
    for rows in (table.exact, table.shown):
        assert set(rows["verdict"]) == {said}


def test_other_units_are_refused():
    with pytest.raises(InputError, match=r"extensions.mine.other.units: it is in 'V'"):
        real_records({"mine": verdict(unit="mV")}, GOAL)
