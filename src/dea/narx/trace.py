"""The record of a selection: every candidate model, its gain and whether it was accepted."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from dea.store import variable

_LABELS = {
    "phase": "phase of the selection",
    "step": "step within the phase",
    "term": "term tried",
    "msse": "mean squared simulated error of the trial, normalised output",
    "serr": "simulated error reduction ratio, negative where the error rises",
    "status": "what became of the trial",
}


def serr(before: float, after: float, power: float) -> float:
    """Simulated error reduction ratio (5), where an unstable model has an infinite error."""
    if not np.isfinite(after):
        return -np.inf
    if not np.isfinite(before):
        return np.inf
    return (before - after) / power


class Tried(NamedTuple):
    """A candidate model of one step."""

    label: str  # the term added, dropped or exchanged
    msse: float
    serr: float


class Trace:
    """Collects candidate models in the order in which they were tried."""

    def __init__(self) -> None:
        self._rows: list[tuple[str, int, str, float, float, str]] = []
        self.threshold: float | None = None  # the share of the output that a term was worth

    def add(
        self,
        phase: str,
        step: int,
        candidates: Sequence[Tried],
        accepted: int | None = None,
        status: str = "",
    ) -> None:
        """Add the candidates of one step; the one of index ``accepted`` has this ``status``."""
        for i, tried in enumerate(candidates):
            outcome = "rejected" if np.isfinite(tried.msse) else "unstable"
            self._rows.append((phase, step, *tried, status if i == accepted else outcome))

    def to_dataset(self) -> xr.Dataset:
        """Return the candidates with dimension ``trial``, as ``model.nc`` names and holds them."""
        columns = zip(*self._rows, strict=True) if self._rows else [()] * len(_LABELS)
        dataset = xr.Dataset(
            {
                f"trial_{name}": variable("trial", np.array(column), "1", label)
                for (name, label), column in zip(_LABELS.items(), columns, strict=True)
            }
        )
        if self.threshold is not None:
            label = "share of the output's mean square that a term had to explain"
            dataset["threshold"] = variable((), self.threshold, "1", label)
        return dataset
