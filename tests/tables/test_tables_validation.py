"""The table of validation holds every score of the datasets."""

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
