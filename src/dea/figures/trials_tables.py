"""The blind trials in numbers: rates with their intervals, and outcomes by effect."""

from math import isnan

import pandas as pd
import xarray as xr

from dea.figures.symbols import DASH
from dea.figures.tables import Table

_AT_MOST = {"name given on nothing", "name given on a foreign effect"}


def rates(scores: xr.Dataset) -> Table:
    """Rates with Wilson's 95 % intervals and what was to be reached (contract ``scores``)."""
    exact = scores[["rate", "rate_low", "rate_high", "rate_trials", "rate_target"]].to_dataframe()
    shown = [
        {
            "measure": str(measure),
            "rate (%)": _percent(row["rate"]),
            "95 % interval (%)": f"{_percent(row['rate_low'])} to {_percent(row['rate_high'])}",
            "trials": str(int(row["rate_trials"])),
            "target (%)": _target(str(measure), row["rate_target"]),
        }
        for measure, row in exact.iterrows()
    ]
    return Table(exact.reset_index(), pd.DataFrame(shown))


def effects(scores: xr.Dataset) -> Table:
    """How often each hidden effect met each outcome, and what it was taken for."""
    counts = scores["effect_outcomes"].to_pandas()
    counts = counts[counts.sum(axis=1) > 0]
    confusion = scores["confusion"].to_pandas().loc[counts.index]
    wrong = [
        ", ".join(
            f"{said} ({count})"
            for said, count in row.items()
            if count and said not in (hidden, "ambiguous", "unknown")
        )
        for hidden, row in confusion.iterrows()
    ]
    exact = counts.assign(trials=counts.sum(axis=1)).reset_index()
    exact.columns.name = None
    exact = exact.rename(columns={"hidden_effect": "hidden"}).assign(**{"taken for": wrong})
    return Table(exact, exact.astype(str).replace({"taken for": {"": DASH}}))


def _percent(share: float) -> str:
    return DASH if isnan(share) else f"{100 * share:.0f}"


def _target(measure: str, share: float) -> str:
    if isnan(share):
        return DASH
    return f"{'at most' if measure in _AT_MOST else 'at least'} {_percent(share)}"
