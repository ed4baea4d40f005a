"""How the published models are identified again from records that they simulate."""

import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, score

_ERRORS = ("nmse", "h1_error", "h2_error")


def tabulate(sources: Sources) -> Table:
    """Make it from ``recovery.nc``."""
    return recovery(sources.dataset("recovery"))


def recovery(scores: xr.Dataset) -> Table:
    """Errors and terms of each published model (``recovery.nc``), by excitation and search."""
    counts = ["terms found", "foreign terms"]
    exact, shown = [], []
    for plant in scores["plant"].values:
        for excitation in scores["excitation"].values:
            for search in scores["search"].values:
                case = scores.sel(plant=plant, excitation=excitation, search=search)
                own = int(case["plant_terms"])
                found, foreign = (int(case[n].round()) for n in ("terms_common", "terms_foreign"))
                row = {"plant": str(plant), "excitation": str(excitation), "search": str(search)}
                row["stability"] = str(case["stability"].values)
                values = {name: float(case[name]) for name in _ERRORS}
                exact.append(row | values | dict(zip(counts, (found, foreign), strict=True)))
                shown.append(
                    row
                    | {name: score(name, value) for name, value in values.items()}
                    | dict(zip(counts, (f"{found} of {own}", str(foreign)), strict=True))
                )
    return Table(pd.DataFrame(exact), pd.DataFrame(shown))
