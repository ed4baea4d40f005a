import numpy as np
import xarray as xr

from dea.tables.recovery import recovery


def test_every_case_is_a_row_with_exact_and_rounded_values():
    dims = ("plant", "excitation", "search")
    values = {
        "nmse": 1.23456e-7,
        "h1_error": 0.012345,
        "h2_error": np.inf,
        "terms_common": 9.0,
        "terms_foreign": 2.0,
    }
    scores = xr.Dataset(
        {name: (dims, np.full((2, 2, 1), value)) for name, value in values.items()}
        | {"stability": (dims, [[["stable"], ["slow"]], [["unstable"], ["stable"]]])},
        coords={
            "plant": ["DEA1", "DEA2"],
            "excitation": ["coloured", "white"],
            "search": ["refined"],
            "plant_terms": ("plant", [11, 10]),
        },
    )
    table = recovery(scores)
    assert table.exact["plant"].tolist() == ["DEA1", "DEA1", "DEA2", "DEA2"]
    assert table.exact["nmse"].tolist() == [1.23456e-7] * 4
    statuses = ["stable", "slow", "unstable", "stable"]
    assert table.exact["stability"].tolist() == table.shown["stability"].tolist() == statuses
    first = table.shown.iloc[0].to_dict()
    assert first["excitation"] == "coloured"
    assert (first["terms found"], first["foreign terms"]) == ("9 of 11", "2")
    assert (first["nmse"], first["h1_error"], first["h2_error"]) == (
        "1.23e-07",
        "0.0123",
        "diverged",
    )
