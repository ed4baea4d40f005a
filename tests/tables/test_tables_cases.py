"""The table of cases puts each error beside the published one of the same units."""

import pytest
import xarray as xr

from dea.errors import InputError
from dea.tables.cases import cases


def scores(units="V"):
    one = {"units": "1"}
    return xr.Dataset(
        {
            "nmse": ("part", [0.01, 0.04], one),
            "rmse": ("part", [0.2, float("inf")], {"units": units}),
            "samples": ("part", [90, 40], one),
            "stability": ((), "slow", one),
            "terms": ((), 7, one),
            "initial_outputs": ((), 3, one),
        },
        coords={"part": ["first", "second"]},
    )


def test_an_error_is_set_beside_the_published_one():
    table = cases({"mine": scores()}, {"mine": {"first": {"rmse": 0.4, "units": "V"}}})
    first, second = table.exact.to_dict("records")
    assert first["rmse/published"] == pytest.approx(0.5)
    assert (first["terms"], first["initial outputs"]) == (7, 3)
    assert second["published rmse"] != second["published rmse"]  # not a number: none is published
    assert list(table.shown["case"]) == ["mine", "mine"]
    assert list(table.shown["stability"]) == list(table.exact["stability"]) == ["slow", "slow"]


def test_other_units_are_refused():
    with pytest.raises(InputError, match=r"errors.mine.first.units: it is in 'mV'"):
        cases({"mine": scores()}, {"mine": {"first": {"rmse": 400, "units": "mV"}}})
