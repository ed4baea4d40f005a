"""The outcomes of the blind trials by hidden effect."""

import xarray as xr

from dea.number_format import DASH
from dea.store import Sources
from dea.tables.table import Table

_TWO = "two effects"
_NO_NAME = "ambiguous", "unknown", "none"


def tabulate(sources: Sources) -> Table:
    """Make it from ``scores.nc`` of a set of trials."""
    return effects(sources.dataset("scores"))


def effects(scores: xr.Dataset) -> Table:
    """Number of trials by hidden effect and outcome, and the wrong names given.

    Of two effects a single name may be that of one of them.
    """
    counts = scores["effect_outcomes"].to_pandas()
    counts = counts[counts.sum(axis=1) > 0]
    confusion = scores["confusion"].to_pandas().loc[counts.index]
    wrong = [
        ", ".join(
            f"{said} ({count})"
            for said, count in row.items()
            if count and hidden != _TWO and said not in (hidden, *_NO_NAME)
        )
        for hidden, row in confusion.iterrows()
    ]
    exact = counts.assign(trials=counts.sum(axis=1)).reset_index()
    exact.columns.name = None
    exact = exact.rename(columns={"hidden_effect": "hidden"}).assign(**{"taken for": wrong})
    return Table(exact, exact.astype(str).replace({"taken for": {"": DASH}}))
