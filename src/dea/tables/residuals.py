"""What the residuals of every actuator's models still hold, in words and numbers."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, rounded


def tabulate(sources: Sources) -> Table:
    """Make it from ``validation.nc`` of every actuator."""
    return residuals(sources.datasets("validation"))


def residuals(validations: Mapping[str, xr.Dataset]) -> Table:
    """Smallest p-value of each joint test over the windows, and the verdict (``validation``).

    Where the free run of a window diverges, there is no residual, and so no p-value.
    """
    rows = []
    for name, dataset in validations.items():
        for model in dataset["model"].values:
            forecasts = dataset.sel(model=model, approach="forecast")
            count = forecasts["p_value"].size if np.isfinite(forecasts["nmse"]).all() else np.nan
            rows.append(
                {"actuator": name, "model": str(model)}
                | {
                    f"p of {test}": float(
                        np.minimum(count * forecasts["p_value"].sel(test=test).min(), 1.0)
                    )
                    for test in forecasts["test"].values
                }
                | {"verdict": str(forecasts["verdict"].values)}
            )
    return rounded(pd.DataFrame(rows))
