"""The table of forecasts holds what its datasets do."""

import made_datasets as made
from dea.tables.forecast import forecast


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
