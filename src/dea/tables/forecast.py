"""Errors of forecasts: the NARX model beside four simpler ways to forecast."""

from collections.abc import Mapping

import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, rounded

_NAMES = {
    "narx": "NARX",
    "linear": "linear ARX",
    "hammerstein": "one-pole Hammerstein",
    "cubic": "memoryless cubic",
    "last value": "last value",
}


def tabulate(sources: Sources) -> Table:
    """Make it from ``forecast.nc`` of every actuator."""
    return forecast(sources.datasets("forecast"))


def forecast(found: Mapping[str, xr.Dataset]) -> Table:
    """Root mean square errors over every horizon (contract ``forecast``)."""
    rows = []
    for name, dataset in found.items():
        rmse = dataset["rmse"]
        units = rmse.attrs["units"]
        labels = {each: _NAMES[each] for each in map(str, rmse["forecaster"].values)}
        for horizon in dataset["horizon"].values:
            at_horizon = rmse.sel(horizon=horizon)
            errors = {each: float(at_horizon.sel(forecaster=each)) for each in labels}
            rows.append(
                {"actuator": name, "horizon (s)": float(horizon)}
                | {f"{label} ({units})": errors[each] for each, label in labels.items()}
                | {
                    "NARX/cubic": errors["narx"] / errors["cubic"],
                    "NARX/Hammerstein": errors["narx"] / errors["hammerstein"],
                }
            )
    return rounded(pd.DataFrame(rows))
