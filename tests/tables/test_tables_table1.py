"""Table 1 holds the parameters and scores of the datasets: exact in CSV, rounded for readers."""

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import made_datasets as made
from dea.number_format import number
from dea.tables.table import CAPTIONS
from dea.tables.table1 import _estimate, table1


def test_table1_holds_every_parameter_and_score(each, names, saved):
    models, validations = each(made.model), each(made.validation)
    common = made.common_model(names)
    csv, md, tex = saved(table1(models, validations, common))
    own, shared = (csv[csv.structure == each].set_index("term") for each in ("own", "common"))
    for name in names:
        model = models[name]
        for term in map(str, model["term"].values):
            row = model.sel(term=term)
            for column, quality in (
                (name, "parameter"),
                (f"{name} standard error", "standard_error"),
                (f"{name} inclusion frequency", "inclusion_frequency"),
            ):
                assert float(own.loc[term, column]) == float(row[quality])
        assert int(own.loc["number of terms", name]) == model["term"].size
        assert own.loc["stability", name] == model.attrs["stability"]
        for approach in ("forecast", "fitted, one-step"):
            scores = validations[name].sel(model="narx", approach=approach).isel(window=0)
            for label, score in (("nmse", "nmse"), ("fit", "fit"), ("fpe (mm^2)", "fpe")):
                assert float(own.loc[f"{label}, {approach}", name]) == float(scores[score])
        for term in map(str, common["term"].values):
            row = common.sel(term=term, system=name)
            assert float(shared.loc[term, name]) == float(row["parameter"])
        errors = common["nmse"].sel(system=name)
        alone, together = (float(errors.sel(structure=each)) for each in ("own", "common"))
        assert float(own.loc["nmse, data not used", name]) == alone
        assert float(shared.loc["nmse, data not used", name]) == together
        assert float(shared.loc["nmse, common over own", name]) == pytest.approx(together / alone)
    header = [cell.strip() for cell in md.splitlines()[0].strip("|").split("|")]
    assert header == ["structure", "term", *names]
    assert all(len(line.split("|")) == len(names) + 4 for line in md.splitlines()[:-2])
    assert md.splitlines()[-2:] == ["", CAPTIONS]
    assert tex.count(r"\\") == len(csv) + 1
    assert "$y_{t-1}u_{t-3}^{2}$" in tex


def test_standard_errors_that_do_not_hold_are_withheld_with_the_reason(names, saved, each):
    models, common = each(made.model), made.common_model(names)
    models[names[0]].attrs["withheld"] = "the residual is not white"
    common["withheld"] = common["withheld"].astype(object)
    common["withheld"][-1] = "too few equations"
    csv, md, _ = saved(table1(models, each(made.validation), common))
    own, shared = (csv[csv.structure == kind].set_index("term") for kind in ("own", "common"))
    label = "standard errors withheld"
    assert own.loc[label, names[0]] == "the residual is not white"
    assert shared.loc[label, names[-1]] == "too few equations"
    assert own.get(f"{names[0]} standard error", pd.Series(dtype=float)).isna().all()
    term = str(models[names[0]]["term"].values[0])
    cells = [
        line.split("|")[3].strip()
        for line in md.splitlines()
        if [cell.strip() for cell in line.split("|")[1:3]] == ["own", term]
    ]
    value = float(models[names[0]]["parameter"].sel(term=term))
    [cell] = cells
    assert cell.startswith(f"{number(value, 4)} ± withheld (")


def test_table1_prints_inclusion_frequencies_of_own_terms_alone():
    models = {"dea1": made.model(1)}
    shown = table1(models, {"dea1": made.validation(1)}, made.common_model(["dea1"])).shown
    shown = shown.set_index(["structure", "term"])["dea1"]
    term = str(models["dea1"]["term"].values[0])
    share = float(models["dea1"]["inclusion_frequency"].sel(term=term))
    assert shown["own", term].endswith(f"({100 * share:.0f} %)")
    assert "%" not in shown["common", term]


def test_table1_marks_a_term_a_model_does_not_have(saved):
    models = {"dea1": made.model(1), "dea2": made.model(2)}
    validations = {n: made.validation(1) for n in models}
    csv, md, tex = saved(table1(models, validations, made.common_model(list(models))))
    absent = set(made.TERMS) - set(map(str, models["dea1"]["term"].values))
    assert len(absent) == 1
    term = absent.pop()
    assert csv[csv.structure == "own"].set_index("term")["dea1"].isna()[term]
    row = next(line for line in md.splitlines() if line.split("|")[2].strip() == term)
    assert row.split("|")[3].strip() == "–"
    assert "–" not in tex
    assert "--" in tex


def test_table1_orders_terms_by_degree():
    models = {"dea1": made.model(5), "dea2": made.model(6)}
    validations = {name: made.validation(1) for name in models}
    table = table1(models, validations, made.common_model(list(models)))
    terms = table.exact["term"][: len(made.TERMS)].to_list()
    assert terms == made.TERMS


@given(st.floats(-100, 100), st.floats(1e-9, 50))
def test_an_estimate_has_the_digits_that_its_error_leaves(value, error):
    text, error_text = _estimate(value, error).split(" ± ")
    shown, shown_error = float(text), float(error_text)
    decimals = len(error_text.partition(".")[2])
    assert abs(shown - value) <= 0.5001 * 10.0**-decimals
    assert len(text.partition(".")[2]) == decimals
    assert shown_error == pytest.approx(error, rel=0.5 if error > 1 else 0.17)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.23456, 0.0123, "1.235 ± 0.012"),
        (1.23456, 0.0345, "1.23 ± 0.03"),
        (-0.5, 0.1, "-0.50 ± 0.10"),
        (1.0, 0.0, "1.000"),
    ],
)
def test_the_place_of_an_error_decides_the_digits(value, error, text):
    assert _estimate(value, error) == text
