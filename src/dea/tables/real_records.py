"""The table of the diagnosed cases: named effects and errors on samples not fitted to."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from dea.number_format import DASH, number
from dea.store import Sources
from dea.tables.published import check_units, published_errors
from dea.tables.table import Table

_NO_NAME = "no name"
_KEPT = "kept block"


def tabulate(sources: Sources) -> Table:
    """Make it from ``verdict.json`` of every diagnosed case and ``published_errors.yaml``."""
    published = published_errors(sources)["extensions"]
    return real_records(sources.documents("verdict"), published)


def real_records(
    verdicts: Mapping[str, Mapping[str, Any]],
    published: Mapping[str, Mapping[str, Mapping[str, Any]]],
) -> Table:
    """Errors without and with the named effects, beside published ones.

    They are those on the samples of role certify, and on every test record.

    Parameters
    ----------
    verdicts
        Content of ``verdict.json`` by the cases' names.
    published
        By case and test record, for those that have one: ``before`` and ``after``, the rmse
        without and with the effect, and their ``units``; or ``effect: none``, where others found
        none that a record can show.

    Raises
    ------
    InputError
        If a published error is in other units than the record.
    """
    exact, shown = [], []
    for name, verdict in verdicts.items():
        named = verdict["status"] == "named"
        effects = " + ".join(effect["name"] for effect in verdict["effects"])
        for part, errors in _certified(verdict["certified"]).items():
            goal = published.get(name, {}).get(part)
            if goal and "units" in goal:
                check_units(goal, verdict["unit"], f"extensions.{name}.{part}")
            label = {"case": name, "verdict": _status(verdict), "effects": effects}
            values = {
                "rmse before": errors["before"],
                "rmse after": errors["after"],
                "noise floor": verdict["noise_floor"],
                "published before": goal.get("before") if goal else None,
                "published after": goal.get("after") if goal else None,
            }
            met = _met(goal, named, errors["after"])
            units = {"units": verdict["unit"]}
            exact.append(label | {"test record": part} | values | {"met": met} | units)
            texts = {key: DASH if v is None else number(v) for key, v in values.items()}
            if goal and goal.get("effect") == "none":
                texts["published after"] = _NO_NAME
            shown.append(
                label
                | {"effects": effects or DASH, "test record": part}
                | texts
                | {"met": DASH if met is None else "yes" if met else "no"}
                | units
            )
    return Table(pd.DataFrame(exact), pd.DataFrame(shown))


def _status(verdict: Mapping[str, Any]) -> str:
    """Return the status, and of names that are not all of the answer, or not sure, that too."""
    if verdict["whole"] is False:
        return f"{verdict['status']} in part"
    return f"{verdict['status']}, law too poor" if verdict["law_too_poor"] else verdict["status"]


def _certified(certified: Mapping[str, Any]) -> dict[str, Mapping[str, float]]:
    kept = {"before": certified["rmse_before"], "after": certified["rmse_after"]}
    return {_KEPT: kept, **certified["records"]}


def _met(goal: Mapping[str, Any] | None, named: bool, after: float) -> bool | None:
    """Return whether a published result is reached; ``None`` where there is none."""
    if goal is None:
        return None
    if goal.get("effect") == "none":
        return not named
    return named and after <= goal["after"]
