"""Table 1 holds the parameters and scores of the datasets: exact in CSV, rounded for readers."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import made_datasets as made
from dea.tables.table1 import _estimate, table1


def test_table1_holds_every_parameter_and_score(each, names, saved):
    models, validations = each(made.model), each(made.validation)
    csv, md, tex = saved(table1(models, validations))
    csv = csv.set_index("term")
    for name in names:
        model = models[name]
        found = csv[name].dropna()
        for term in map(str, model["term"].values):
            row = model.sel(term=term)
            assert csv.loc[term, name] == float(row["parameter"])
            assert csv.loc[term, f"{name} standard error"] == float(row["standard_error"])
            assert csv.loc[term, f"{name} inclusion frequency"] == float(row["inclusion_frequency"])
        assert csv.loc["number of terms", name] == model["term"].size
        assert len(found) == model["term"].size + 1 + 6
        for approach in ("forecast", "fitted, one-step"):
            scores = validations[name].sel(model="narx", approach=approach).isel(window=0)
            assert csv.loc[f"nmse, {approach}", name] == float(scores["nmse"])
            assert csv.loc[f"fit, {approach}", name] == float(scores["fit"])
            assert csv.loc[f"fpe (mm^2), {approach}", name] == float(scores["fpe"])
    header = [cell.strip() for cell in md.splitlines()[0].strip("|").split("|")]
    assert header == ["term", *names]
    assert all(len(line.split("|")) == len(names) + 3 for line in md.splitlines())
    assert tex.count(r"\\") == len(csv) + 1
    assert "$y_{t-1}u_{t-3}^{2}$" in tex


def test_table1_marks_a_term_a_model_does_not_have(saved):
    models = {"dea1": made.model(1), "dea2": made.model(2)}
    csv, md, tex = saved(table1(models, {n: made.validation(1) for n in models}))
    absent = set(made.TERMS) - set(map(str, models["dea1"]["term"].values))
    assert len(absent) == 1
    term = absent.pop()
    assert math.isnan(csv.set_index("term").loc[term, "dea1"])
    row = next(line for line in md.splitlines() if line.startswith(f"| {term} "))
    assert row.split("|")[2].strip() == "–"
    assert "–" not in tex
    assert "--" in tex


def test_table1_orders_terms_by_degree():
    models = {"dea1": made.model(5), "dea2": made.model(6)}
    table = table1(models, {name: made.validation(1) for name in models})
    terms = table.exact["term"][: len(made.TERMS)].to_list()
    assert terms == made.TERMS


@given(st.floats(-100, 100), st.floats(1e-9, 50))
def test_an_estimate_is_shown_to_its_errors_second_digit(value, error):
    shown, shown_error = map(float, _estimate(value, error).split(" ± "))
    assert abs(shown - value) <= max(0.05 * error, 0.5)
    assert shown_error == pytest.approx(error, rel=0.06)
