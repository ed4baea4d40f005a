"""Tables hold the numbers of the datasets: exactly in CSV, rounded for readers."""

import math

import made_datasets as made
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.figures import tables
from dea.figures.symbols import number, residual_test_as_mathematics


@pytest.fixture
def saved(tmp_path):
    def save(table):
        paths = {kind: tmp_path / f"t.{kind}" for kind in ("csv", "md", "tex")}
        tables.save(table, **paths)
        return pd.read_csv(paths["csv"]), paths["md"].read_text(), paths["tex"].read_text()

    return save


def test_table1_holds_every_parameter_and_score(each, names, saved):
    models, validations = each(made.model), each(made.validation)
    csv, md, tex = saved(tables.table1(models, validations))
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
        for approach in ("honest", "re-estimated"):
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
    csv, md, tex = saved(tables.table1(models, {n: made.validation(1) for n in models}))
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
    table = tables.table1(models, {name: made.validation(1) for name in models})
    terms = table.exact["term"][: len(made.TERMS)].to_list()
    assert terms == made.TERMS


def test_the_validation_table_holds_every_score(each, names, saved):
    validations = each(made.validation)
    csv, md, _ = saved(tables.validation(validations))
    assert len(csv) == len(names) * 3 * 2 * 2 == len(md.splitlines()) - 2
    windows = sorted(set(csv["window (s)"]))
    assert windows == ["100-130", "1700-1730", "900-930"]
    for _, row in csv.iterrows():
        window = ["100-130", "900-930", "1700-1730"].index(row["window (s)"])
        scores = validations[row["actuator"]].isel(window=window)
        scores = scores.sel(model=row["model"], approach=row["approach"])
        for score, column in (("nmse", "nmse"), ("fit", "fit"), ("fpe", "fpe (mm^2)"),
                              ("rmse", "rmse (mm)")):  # fmt: skip
            assert row[column] == float(scores[score])


def test_the_tracking_table_holds_every_score(each, names, saved):
    tracks = each(made.track)
    csv, _, tex = saved(tables.tracking(tracks))
    assert len(csv) == 4 * len(names)
    for _, row in csv.iterrows():
        track = tracks[row["actuator"]].sel(simulation=row["parameters"])
        assert (row["nmse"], row["rmse (mm)"]) == (float(track["nmse"]), float(track["rmse"]))
    assert r"\toprule" in tex


def test_a_simulation_that_diverged_is_said_to_have(saved):
    track = made.track(1)
    track["nmse"][0] = math.inf
    csv, md, _ = saved(tables.tracking({"dea1": track}))
    assert csv["nmse"][0] == math.inf
    assert "diverged" in md.splitlines()[2]


@given(st.floats(-1e12, 1e12).filter(lambda x: abs(x) > 1e-12))
def test_a_rounded_number_is_within_half_of_its_last_digit(value):
    assert float(number(value)) == pytest.approx(value, rel=5.1e-3)


@given(st.floats(-100, 100), st.floats(1e-9, 50))
def test_an_estimate_is_shown_to_its_errors_second_digit(value, error):
    shown, shown_error = map(float, tables._estimate(value, error).split(" ± "))
    assert abs(shown - value) <= max(0.05 * error, 0.5)
    assert shown_error == pytest.approx(error, rel=0.06)


@pytest.mark.parametrize(
    ("test", "mathematics"),
    [
        ("phi_ee", r"$\phi_{ee}$"),
        ("phi_e(eu)", r"$\phi_{e(eu)}$"),
        ("phi_u2e2", r"$\phi_{u^2e^2}$"),
    ],
)
def test_a_residual_test_as_mathematics(test, mathematics):
    assert residual_test_as_mathematics(test) == mathematics
