"""Tables of forecasts, confirmation and residuals hold what their datasets do."""

import numpy as np

import made_datasets as made
from dea.number_format import DASH
from dea.tables.confirmation import confirmation
from dea.tables.forecast import forecast
from dea.tables.residuals import residuals


def test_the_forecast_table_holds_every_error_and_two_ratios(each, names, saved):
    found = each(made.forecast)
    csv, md, _ = saved(forecast(found))
    assert len(csv) == 3 * len(names) == len(md.splitlines()) - 2
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
    csv, md, _ = saved(confirmation(found))
    assert len(csv) == 3 * len(names) == len(md.splitlines()) - 2
    first = csv.iloc[0]
    assert first["time (min)"] == 5.0
    # Of the lines at 0.05, 0.5 and 1 Hz, the one at 0.5 Hz is outside.
    assert (first["lines in band"], first["lines"]) == (2, 3)
    assert first["largest difference of gain (%)"] == -10.0
    assert (first["even lines in band"], first["even lines"]) == (1, 2)
    assert md.splitlines()[2].split("|")[3:5] == [" 3       ", " 2               "]
    assert first["gain at 5 Hz (%)"] == -50.0


def test_the_residual_table_corrects_for_the_number_of_tests(each, names, saved):
    found = each(made.validation)
    csv, _, _ = saved(residuals(found))
    assert len(csv) == 2 * len(names)
    for _, row in csv.iterrows():
        chosen = found[row["actuator"]].sel(model=row["model"], approach="forecast")
        assert row["verdict"] == str(chosen["verdict"].values)
        smallest = float(chosen["p_value"].sel(test="phi_eu").min())
        assert row["p of phi_eu"] == min(15 * smallest, 1.0)


def test_a_model_that_diverges_has_no_p_value(each, names, saved):
    found = each(made.validation)
    found["dea1"]["nmse"].loc[{"model": "narx", "approach": "forecast"}][1] = np.inf
    _, md, _ = saved(residuals(found))
    [row] = [line.split("|") for line in md.splitlines() if "dea1" in line and "narx" in line]
    assert {cell.strip() for cell in row[3:-2]} == {DASH}
