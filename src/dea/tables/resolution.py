"""Round by round, what designed records have decided.

The stage that drives them makes it, of all systems that it has been asked about.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from dea.tables.table import Table, rounded


def resolution(found: Mapping[str, xr.Dataset]) -> Table:
    """One row for each round of each system (contract ``resolution``)."""
    rows = []
    for name, dataset in found.items():
        for number in range(dataset.sizes["round"]):
            part = dataset.isel(round=number)
            likeliest = int(np.nanargmax(part["probability"].values))
            last = number == dataset.sizes["round"] - 1
            unit = part["error_after"].attrs["units"]
            rows.append(
                {
                    "system": name,
                    "round": number,
                    "driven (s)": float(part["driven"]),
                    "verdict": str(part["status"].values),
                    "names": str(part["names"].values),
                    "likeliest": str(part["hypothesis"].values[likeliest]),
                    "probability": float(part["probability"][likeliest]),
                    "hypotheses left": int(
                        np.sum(
                            np.isfinite(part["probability"].values) & (part["rejected"].values == 0)
                        )
                    ),
                    f"error before ({unit})": float(part["error_before"]),
                    f"error after ({unit})": float(part["error_after"]),
                    "outcome": str(dataset.attrs["outcome"]) if last else "",
                }
            )
    return rounded(pd.DataFrame(rows))
