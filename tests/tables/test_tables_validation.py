"""The table of validation holds every score of the datasets."""

import numpy as np
import pytest

import made_datasets as made
from dea.tables.validation import validation


def test_the_validation_table_holds_every_score(each, names, saved):
    validations = each(made.validation)
    csv, md, _ = saved(validation(validations))
    assert len(csv) == len(names) * 3 * 2 * 4 == len(md.splitlines()) - 4
    windows = sorted(set(csv["window (s)"]))
    assert windows == ["100-130", "1700-1730", "900-930"]
    for _, row in csv.iterrows():
        window = ["100-130", "900-930", "1700-1730"].index(row["window (s)"])
        scores = validations[row["actuator"]].isel(window=window)
        scores = scores.sel(model=row["model"], approach=row["approach"])
        for score, column in (("nmse", "nmse"), ("fit", "fit"), ("fpe", "fpe (mm^2)"),
                              ("rmse", "rmse (mm)")):  # fmt: skip
            assert row[column] == float(scores[score])


@pytest.mark.parametrize(
    ("windows", "rate", "told"),
    [
        ([[0.1, 0.4], [0.4, 0.7]], 1000.0, ["0.1-0.4", "0.4-0.7"]),
        ([[100.0, 100.5], [100.5, 101.0]], 50.0, ["100-100.5", "100.5-101"]),
        # As near to whole seconds as the samples come.
        ([[900.0, 930.0], [1700.0, 1730.0]], 33.335, ["900-930", "1700-1730"]),
    ],
)
def test_windows_are_told_from_each_other(saved, windows, rate, told):
    begins = [round(begin * rate) for begin, _ in windows]
    size = round((windows[0][1] - windows[0][0]) * rate)
    dataset = made.validation(1)[["nmse", "fit", "fpe", "rmse"]].isel(window=slice(2))
    time = (np.array(begins)[:, None] + np.arange(size)) / rate
    csv, _, _ = saved(validation({"dea1": dataset.assign(time=(("window", "sample"), time))}))
    assert sorted(set(csv["window (s)"])) == sorted(told)
