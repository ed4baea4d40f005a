"""Rates and tables against hand counts."""

from math import inf, nan

import pytest

from benchmarks.naming.campaign import Said, Tried
from benchmarks.naming.methods import REFERENCE, methods
from benchmarks.naming.scores import OURS, lower, rates, ratios, scored, table, table_of_answers
from dea.trials import Label, wilson


def label(*effects, outside=False):
    return Label(frozenset(effects), outside, 5.0, "gaussian")


def said(status, *effects, error=1.0, rivals=(), seconds=2.0):
    return Said(status, frozenset(effects), rivals, error, seconds)


def tried(name, what, answer):
    """A trial on which every method says the same, but the simulation alone."""
    answers = dict.fromkeys(methods(), answer) | {REFERENCE: said("none", error=2.0)}
    return Tried(name, what, answers)


TRIED = [
    tried("0", label("dead_zone"), said("named", "dead_zone", error=0.5)),
    tried("1", label("sensor_lag"), said("named", "electrode_lag", error=1.0)),
    tried("2", label("sensor_lag"), said("named", "dead_zone", "sensor_lag", error=3.0)),
    tried("3", label("sensor_lag"), said("unknown")),
    tried("4", label("sensor_lag"), said("none", error=2.0)),
    tried("5", label("sensor_lag"), said("ambiguous", "sensor_lag", error=nan,
                                         rivals=(frozenset({"transport_delay"}),))),
    tried("6", label("dead_zone", "sensor_lag"), said("named", "dead_zone", "sensor_lag")),
    tried("7", label("dead_zone", "sensor_lag"), said("named", "dead_zone")),
    tried("8", label("dead_zone", "sensor_lag"), said("named", "gain_drift")),
    tried("9", label(), said("none", error=2.0)),
    tried("10", label(), said("named", "dead_zone", error=4.0)),
    tried("11", label("speckle", outside=True), said("named", "dead_zone")),
    tried("12", label("speckle", outside=True), said("unknown")),
]  # fmt: skip


def test_rates_are_those_counted_by_hand():
    found = rates(scored(TRIED, "sindy"))
    assert found == {
        "right name": wilson(1, 6),
        "right name, alone or with another": wilson(2, 6),
        "right class": wilson(3, 6),
        "wrong name": wilson(1, 6),
        "no name (`ambiguous`, `unknown`)": wilson(1, 6),
        "nothing missing, it says": wilson(1, 6),
        "both of two": wilson(1, 3),
        "one or both of two, nothing wrong": wilson(2, 3),
        "name given on nothing": wilson(1, 2),
        "name given on a foreign effect": wilson(1, 2),
        "names given that are right": wilson(3, 8),
    }


def test_errors_are_divided_by_those_of_the_simulation_alone():
    found = scored(TRIED, "sindy")
    assert ratios(found, missing=False).tolist() == [1.0, 2.0]
    expected = [0.25, 0.5, 1.5, 0.5, 1.0, 0.5, 0.5, 0.5, 0.5, 0.5]
    assert ratios(found, missing=True).tolist() == expected


def test_lower_errors_are_counted_pair_by_pair():
    def with_errors(name, *errors):
        answers = dict.fromkeys(methods(), said("none", error=2.0))
        return Tried(
            name, label("dead_zone"), answers | dict(zip(("ridge", OURS), errors, strict=True))
        )

    tried = [
        with_errors("0", said("unknown", error=0.90), said("named", "dead_zone", error=1.0)),
        with_errors("1", said("unknown", error=0.96), said("named", "dead_zone", error=1.0)),
        with_errors("2", said("unknown", error=1.50), said("named", "dead_zone", error=1.0)),
        with_errors("3", said("unknown", error=nan), said("named", "dead_zone", error=1.0)),
    ]  # fmt: skip
    tried.append(Tried("4", label(), tried[0].said))
    assert lower(scored(tried, "ridge"), scored(tried, OURS)) == wilson(1, 3)


def test_the_table_has_a_column_for_each_method_and_a_number_in_each_cell():
    lines = [line.strip("|").split("|") for line in table(TRIED)]
    assert len(lines[0]) == len(methods()) + 1
    assert {cell.strip() for cell in lines[0][1:]} == {m.title for m in methods().values()}
    cells = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in lines}
    column = [cell.strip() for cell in lines[0][1:]].index(methods()["sindy"].title)
    assert cells["right name"][column] == "17 (3 to 56)"
    assert cells["unseen error, something missing"][column] == "0.50 (0.50 to 0.50)"
    assert cells["time of a processor (s)"][column] == "2.0"


def test_the_tables_say_where_a_method_failed():
    def failing(each):
        failed = said("unknown", error=nan, seconds=nan)._replace(failed="too short")
        return each._replace(said=each.said | {"sindy": failed})

    trials = [failing(TRIED[0]), failing(TRIED[1]), TRIED[2]]
    header, *_, last = ([cell.strip() for cell in row.split("|")] for row in table(trials))
    counts = dict(zip(header, last, strict=True))
    assert counts["measure"] == "trials that it failed on"
    assert counts[methods()["sindy"].title] == "2"
    assert counts[methods()["ridge"].title] == "0"
    assert "| failed, – |" in table_of_answers(trials, ["sindy"])[2]


def test_the_table_of_answers_marks_right_names():
    away = TRIED[11]._replace(said=TRIED[11].said | {REFERENCE: said("none", error=inf)})
    rows = table_of_answers([TRIED[0], TRIED[9], away], list(methods()))
    assert "**dead_zone**, 0.25" in rows[2]
    assert rows[3].startswith("| 9 (none) |")
    assert rows[3].count("none, 1.00") == len(methods())
    assert rows[4].startswith("| 11 (speckle, foreign) |")
    assert rows[4].count("| dead_zone, – ") == len(methods()) - 1


@pytest.mark.parametrize("what", [label("dead_zone"), label()])
def test_the_simulation_alone_gives_no_name(what):
    given = scored([tried("0", what, said("unknown"))], REFERENCE)
    assert not given[0].named
    assert given[0].ratio == 1.0


def test_where_the_simulation_runs_away_there_is_no_ratio():
    away = TRIED[0]._replace(said=TRIED[0].said | {REFERENCE: said("none", error=inf)})
    found = scored([away, TRIED[1]], "sindy")
    assert ratios(found, missing=True).tolist() == [0.5]
    assert found[0].outcome == "right name"


def test_a_prediction_that_runs_away_is_the_worst_of_all():
    away = tried("0", label("dead_zone"), said("named", "dead_zone", error=inf))
    rows = [line for line in table([TRIED[0], TRIED[1], away]) if "something missing" in line]
    assert rows[0].count("0.50 (0.25 to inf)") == len(methods()) - 1
