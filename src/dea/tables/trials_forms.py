"""The outcomes of the blind trials by the form of the hidden law."""

import xarray as xr

from dea.store import Sources
from dea.tables.table import Table


def tabulate(sources: Sources) -> Table:
    """Make it from ``scores.nc`` of a set of trials."""
    return forms(sources.dataset("scores"))


def forms(scores: xr.Dataset) -> Table:
    """Number of trials with one hidden effect by its form and outcome."""
    counts = scores["form_outcomes"].to_pandas()
    exact = counts.assign(trials=counts.sum(axis=1)).reset_index()
    exact.columns.name = None
    exact.insert(0, "effect", scores["form_effect"].values)
    return Table(exact, exact.astype(str))
