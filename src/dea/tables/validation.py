"""The scores of every actuator, window, model and approach."""

from collections.abc import Mapping
from itertools import count

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

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
            shown = _window(dataset["time"].isel(window=window).values)
            for model in dataset["model"].values:
                for approach in dataset["approach"].values:
                    chosen = dataset.isel(window=window).sel(model=model, approach=approach)
                    rows.append(
                        {
                            "actuator": name,
                            "window (s)": shown,
                            "model": str(model),
                            "approach": str(approach),
                        }
                        | {header(chosen[score]): float(chosen[score]) for score in _SCORES}
                    )
    return rounded(pd.DataFrame(rows))


def _window(time: NDArray[np.float64]) -> str:
    """Return a window of these times (s), with as few decimals as tell a sample from the next."""
    interval = time[1] - time[0]
    return "-".join(
        next(
            f"{end:.{decimals}f}"
            for decimals in count()
            if abs(round(end, decimals) - end) <= 0.5 * interval
        )
        for end in (time[0], time[-1] + interval)
    )
