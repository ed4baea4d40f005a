"""The scores of free-run simulation with fixed and with tracked parameters."""

from collections.abc import Mapping

import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, header, rounded


def tabulate(sources: Sources) -> Table:
    """Make it from ``track.nc`` of every actuator."""
    return tracking(sources.datasets("track"))


def tracking(tracks: Mapping[str, xr.Dataset]) -> Table:
    """Free-run scores over the whole record (contract ``track``), fixed and tracked parameters."""
    rows = []
    for name, track in tracks.items():
        variables = [each for each in track.data_vars.values() if each.dims == ("simulation",)]
        rows += [
            {"actuator": name, "parameters": str(simulation)}
            | {header(score): float(score.sel(simulation=simulation)) for score in variables}
            for simulation in track["simulation"].values
        ]
    return rounded(pd.DataFrame(rows))
