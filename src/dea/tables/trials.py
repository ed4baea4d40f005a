"""The rates of the blind trials with their intervals."""

from math import isnan

import pandas as pd
import xarray as xr

from dea.number_format import DASH
from dea.store import Sources
from dea.tables.table import Table

_RATES = ("rate", "rate_low", "rate_high", "rate_trials", "rate_target")


def tabulate(sources: Sources) -> Table:
    """Make it from ``scores.nc`` of a set of trials."""
    return rates(sources.dataset("scores"))


def rates(scores: xr.Dataset) -> Table:
    """Rates with Wilson's 95 % intervals and their targets (contract ``scores``)."""
    exact = scores[list(_RATES)].to_dataframe()
    at_most = scores["rate_at_most"].to_series()
    shown = [
        {
            "measure": str(measure),
            "rate (%)": _percent(row["rate"]),
            "95 % interval (%)": f"{_percent(row['rate_low'])} to {_percent(row['rate_high'])}",
            "trials": str(int(row["rate_trials"])),
            "target (%)": _target(row["rate_target"], bool(at_most[measure])),
        }
        for measure, row in exact.iterrows()
    ]
    return Table(exact.reset_index(), pd.DataFrame(shown))


def _percent(share: float) -> str:
    return DASH if isnan(share) else f"{100 * share:.0f}"


def _target(share: float, at_most: bool) -> str:
    if isnan(share):
        return DASH
    return f"{'at most' if at_most else 'at least'} {_percent(share)}"
