"""The scores of every actuator, window, model and approach."""

from collections.abc import Mapping

import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, header, rounded

_SCORES = ("nmse", "fit", "fpe", "rmse")


def tabulate(sources: Sources) -> Table:
    """Make it from ``validation.nc`` of every actuator."""
    return validation(sources.datasets("validation"))


def validation(validations: Mapping[str, xr.Dataset]) -> Table:
    """Scores of every actuator, window, model and approach (contract ``validation``)."""
    rows = []
    for name, dataset in validations.items():
        for window in range(dataset["window"].size):
            time = dataset["time"].isel(window=window).values
            for model in dataset["model"].values:
                for approach in dataset["approach"].values:
                    chosen = dataset.isel(window=window).sel(model=model, approach=approach)
                    rows.append(
                        {
                            "actuator": name,
                            "window (s)": f"{time[0]:.0f}-{time[-1]:.0f}",
                            "model": str(model),
                            "approach": str(approach),
                        }
                        | {header(chosen[score]): float(chosen[score]) for score in _SCORES}
                    )
    return rounded(pd.DataFrame(rows))
