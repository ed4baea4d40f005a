"""The table of residual tests holds what its datasets do."""

import numpy as np

import made_datasets as made
from dea.number_format import DASH
from dea.tables.residuals import residuals


def test_the_residual_table_corrects_for_the_number_of_tests(each, names, saved):
    found = each(made.validation)
    csv, _, _ = saved(residuals(found))
    assert len(csv) == 2 * len(names)
    for _, row in csv.iterrows():
        chosen = found[row["actuator"]].sel(model=row["model"], approach="forecast")
        assert row["verdict"] == str(chosen["verdict"].values)
        smallest = float(chosen["p_value"].sel(test="phi_eu").min())
        assert row["p of phi_eu"] == min(15 * smallest, 1.0)


def test_a_model_that_diverges_everywhere_has_no_p_value(each, names, saved):
    found = each(made.validation)
    found["dea1"]["nmse"].loc[{"model": "narx", "approach": "forecast"}] = np.inf
    _, md, _ = saved(residuals(found))
    [row] = [line.split("|") for line in md.splitlines() if "dea1" in line and "narx" in line]
    assert {cell.strip() for cell in row[3:-2]} == {DASH}
    assert "The residual is 1 mm." in row[-2]


def test_a_model_that_diverges_in_a_window_is_tested_in_the_others(saved):
    found = made.validation(1)
    chosen = {"model": "narx", "approach": "forecast"}
    found["nmse"].loc[chosen][1] = np.inf
    found["p_value"].loc[chosen][1] = 0.0
    found["p_value"].loc[chosen][0, 0] = 0.0
    csv, md, tex = saved(residuals({"dea1": found}))
    _, row = csv.to_dict("records")
    smallest = float(found["p_value"].sel(chosen).isel(window=[0, 2]).sel(test="phi_eu").min())
    assert row["p of phi_eu"] == min(10 * smallest, 1.0)
    said = "The free run diverges in 900 to 930 s; the p-values are of the other windows."
    assert row["verdict"] == said
    assert row["p of phi_ee"] == 0.0
    assert "| < 1e-10" in md
    assert r"$< 1 \times 10^{-10}$" in tex
