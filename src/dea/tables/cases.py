"""The table of the cases: errors of free runs on their test records, and published ones."""

from collections.abc import Mapping
from typing import Any

import pandas as pd
import xarray as xr

from dea.number_format import DASH, number
from dea.store import Sources
from dea.tables.published import check_units, published_errors
from dea.tables.table import Table


def tabulate(sources: Sources) -> Table:
    """Make it from ``test_scores.nc`` of every case and ``published_errors.yaml``."""
    published = published_errors(sources)["errors"]
    return cases(sources.datasets("test_scores"), published)


def cases(
    scores: Mapping[str, xr.Dataset], published: Mapping[str, Mapping[str, Mapping[str, Any]]]
) -> Table:
    """Scores of every case and test record, with the published rmse and the ratio of the two.

    Parameters
    ----------
    scores
        Contract ``test_scores``, by the cases' names.
    published
        ``rmse`` and its ``units`` by case and test record, for those that have one.

    Raises
    ------
    InputError
        If a published error is in other units than the record.
    """
    exact, shown = [], []
    for name, dataset in scores.items():
        units = dataset["rmse"].attrs["units"]
        for part in map(str, dataset["part"].values):
            one = dataset.sel(part=part)
            best = _published(published.get(name, {}).get(part), units, f"{name}.{part}")
            stability = {"stability": str(one["stability"].values)}
            counts = {"terms": int(one["terms"]), "initial outputs": int(one["initial_outputs"])}
            rmse = float(one["rmse"])
            values = {
                "nmse": float(one["nmse"]),
                "rmse": rmse,
                "published rmse": best,
                "rmse/published": rmse / best if best else None,
            }
            label = {"case": name, "test record": part}
            exact.append(label | stability | counts | values | {"units": units})
            shown.append(
                label
                | stability
                | {key: str(count) for key, count in counts.items()}
                | {key: DASH if v is None else number(v) for key, v in values.items()}
                | {"units": units}
            )
    return Table(pd.DataFrame(exact), pd.DataFrame(shown))


def _published(entry: Mapping[str, Any] | None, units: str, field: str) -> float | None:
    if entry is None:
        return None
    check_units(entry, units, f"errors.{field}")
    return float(entry["rmse"])
