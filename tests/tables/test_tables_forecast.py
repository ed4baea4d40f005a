"""Tables of forecasts, confirmation and residuals hold what their datasets do."""

import numpy as np
import pytest

import made_datasets as made
from dea.number_format import DASH
from dea.tables.confirmation import confirmation
from dea.tables.forecast import forecast
from dea.tables.residuals import residuals


def test_the_forecast_table_holds_every_error_and_two_ratios(each, names, saved):
    found = each(made.forecast)
    csv, md, _ = saved(forecast(found))
    assert len(csv) == 3 * len(names) == len(md.splitlines()) - 4
    for _, row in csv.iterrows():
        rmse = found[row["actuator"]]["rmse"].sel(horizon=row["horizon (s)"])
        for label, name in (("NARX", "narx"), ("memoryless cubic", "cubic"),
                            ("one-pole Hammerstein", "hammerstein"),
                            ("linear ARX", "linear"), ("last value", "last value")):  # fmt: skip
            assert row[f"{label} (mm)"] == float(rmse.sel(forecaster=name))
        assert row["NARX/cubic"] == row["NARX (mm)"] / row["memoryless cubic (mm)"]
        assert row["NARX/Hammerstein"] == row["NARX (mm)"] / row["one-pole Hammerstein (mm)"]


def test_the_confirmation_table_counts_the_lines_inside(each, names, saved):
    found = each(made.confirmation)
    csv, md, tex = saved(confirmation(found))
    assert len(csv) == 3 * len(names) == len(md.splitlines()) - 4
    first = csv.iloc[0]
    assert first["time (min)"] == 5.0
    # Of the lines at 0.05, 0.5 and 1 Hz, the one at 0.5 Hz is outside.
    assert (first["lines in band"], first["lines"]) == (2, 3)
    assert first["largest difference of gain (%)"] == -10.0
    assert (first["even lines in band"], first["even lines"]) == (1, 2)
    assert md.splitlines()[2].split("|")[3:5] == [" 3       ", " 2               "]
    assert first["gain at 5 Hz (%)"] == -50.0
    heads = [cell.strip() for cell in md.splitlines()[0].split("|")]
    assert {"error of extrapolated gain at 5 Hz (%)", "the model's own band"} <= set(heads)
    assert "even lines, measured over predicted, median" in heads
    assert "in the joint band" in md.splitlines()[2]
    assert tex.count("%") == tex.count(r"\%") > 0  # else a comment to LaTeX


@pytest.mark.parametrize(("lines_in_band", "at_2_hz"), [(3, -50.0), (4, np.nan), (5, np.nan)])
def test_an_extrapolated_gain_is_of_a_line_near_by_outside_the_band(
    lines_in_band, at_2_hz, each, saved
):
    found = {
        name: one.assign_coords(frequency=[0.05, 0.5, 1.0, 1.9, 3.0]).assign(
            in_band=("frequency", np.arange(5) < lines_in_band)
        )
        for name, one in each(made.confirmation).items()
    }
    csv, md, _ = saved(confirmation(found))
    np.testing.assert_array_equal(csv["gain at 2 Hz (%)"], at_2_hz)
    assert csv[["gain at 5 Hz (%)", "gain at 10 Hz (%)"]].isna().all(axis=None)
    assert [cell.strip() for cell in md.splitlines()[2].split("|")[-3:-1]] == [DASH, DASH]


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
