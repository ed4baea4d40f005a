"""The table of controllers is the errors of their datasets over the stroke."""

import numpy as np

import made_datasets as made
from dea.tables.control import control


def test_each_controller_has_its_errors_in_per_cent_and_its_outcome(each, names, saved):
    found = each(made.control)
    csv, md, _ = saved(control(found))
    assert len(csv) == 2 * len(names) == len(md.splitlines()) - 4
    for _, row in csv.iterrows():
        dataset = found[row["actuator"]].sel(controller=row["controller"])
        error = (dataset["measured"] - dataset["reference"]).values
        for minute, part in (("first", error[:3000]), ("last", error[-3000:])):
            expected = 100 * np.sqrt(np.mean(part**2)) / 0.4
            assert np.isclose(row[f"{minute} minute (%)"], expected, equal_nan=True)
        assert csv["effects"].fillna("")[row.name] == dataset["effects"].item()
        assert row["outcome"] == dataset["outcome"].item()
        assert row["fallbacks"] == int(dataset["fallbacks"])
