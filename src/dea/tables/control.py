"""How well controllers followed a reference in the first and in the last minute."""

from collections.abc import Mapping

import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, rounded


def tabulate(sources: Sources) -> Table:
    """Make it from ``control.nc`` of every actuator."""
    return control(sources.datasets("control"))


def control(found: Mapping[str, xr.Dataset]) -> Table:
    """Tracking errors in per cent of the stroke (contract ``control``)."""
    rows = []
    for name, dataset in found.items():
        stroke = dataset["stroke"]
        share = 100.0 * dataset["rms_error"] / stroke
        for controller in dataset["controller"].values:
            one = dataset.sel(controller=controller)
            rows.append(
                {
                    "actuator": name,
                    "controller": str(controller),
                    "effects": str(one["effects"].values),
                    f"stroke ({stroke.attrs['units']})": float(stroke),
                    "first minute (%)": float(share.sel(controller=controller)[0]),
                    "last minute (%)": float(share.sel(controller=controller)[-1]),
                    "fallbacks": int(one["fallbacks"]),
                    "outcome": str(one["outcome"].values),
                }
            )
    return rounded(pd.DataFrame(rows))
