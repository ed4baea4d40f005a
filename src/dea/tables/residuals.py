"""What the residuals of every actuator's models still hold, in words and numbers."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from dea.store import Sources
from dea.tables.table import Table, rounded

_LEAST, _BELOW = 1e-10, "< 1e-10"  # of a p-value that is written out


def tabulate(sources: Sources) -> Table:
    """Make it from ``validation.nc`` of every actuator."""
    return residuals(sources.datasets("validation"))


def residuals(validations: Mapping[str, xr.Dataset]) -> Table:
    """Smallest p-value of each joint test over the windows, and the verdict (``validation``).

    Where the free run of a window diverges, there is no residual. The p-values are then of the
    other windows, and the verdict says which they are not of.
    """
    rows = []
    for name, dataset in validations.items():
        for model in dataset["model"].values:
            forecasts = dataset.sel(model=model, approach="forecast")
            ran = np.isfinite(forecasts["nmse"].values)
            tested = forecasts["p_value"].isel(window=ran)
            rows.append(
                {"actuator": name, "model": str(model)}
                | {
                    _column(test): float(np.minimum(tested.size * p.min(), 1.0))
                    if p.size
                    else np.nan
                    for test, p in ((test, tested.sel(test=test)) for test in tested["test"].values)
                }
                | {"verdict": _verdict(forecasts, ran)}
            )
    exact, shown = rounded(pd.DataFrame(rows))
    tests = {test for dataset in validations.values() for test in dataset["test"].values}
    for column in map(_column, tests):
        shown[column] = shown[column].where(~(exact[column] < _LEAST), _BELOW)
    return Table(exact, shown)


def _column(test: str) -> str:
    return f"p of {test}"


def _verdict(forecasts: xr.Dataset, ran: NDArray[np.bool_]) -> str:
    """Return the verdict in words, or the windows in which the free run diverges, if not in all."""
    if ran.all() or not ran.any():
        return str(forecasts["verdict"].values)
    times = forecasts["time"].values[~ran]
    lost = " and ".join(f"{time[0]:.0f} to {time[-1]:.0f} s" for time in times)
    return f"The free run diverges in {lost}; the p-values are of the other windows."
