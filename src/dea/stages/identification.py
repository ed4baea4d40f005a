"""What the stages of identification share: the segment of a record that models come from."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dea import store
from dea.configuration.lags import largest_lag
from dea.errors import InputError
from dea.missing import ShortPartError, stretches
from dea.stages.setting_source import at_setting


def segment(
    signals: store.Record,
    start: float,
    length: float,
    file: Path,
    section: str = "identification",
) -> slice:
    """Return the samples of ``length`` s from ``start`` s on, as ``section`` of the config says.

    Raises
    ------
    InputError
        If the record ends before.
    """
    first = round(start * signals.sampling_rate)
    last = first + round(length * signals.sampling_rate)
    if last > signals.y.size:
        problem = InputError(
            f"the segment from {start:g} s, {length:g} s long, ends after the record, which is "
            f"{signals.y.size / signals.sampling_rate:g} s long",
            remedy="Choose a segment inside the record.",
        )
        raise at_setting(problem, file, f"{section}.start", f"{section}.length")
    return slice(first, last)


def with_independent(
    signals: store.Record, identification: Mapping[str, Any], orders: Mapping[str, Any], file: Path
) -> tuple[slice, slice]:
    """Return the samples that models come from and independent ones after them, for ``orders``.

    A short record spares independent data only by identifying from less than the segment.

    Raises
    ------
    InputError
        If the record ends before, or the independent data leave nothing of the segment.
    """
    start, end = identification["start"], identification["start"] + identification["length"]
    later = orders.get("start", end)
    if later <= start:
        problem = InputError(
            f"the independent data from {later:g} s on leave nothing of the segment from "
            f"{start:g} s on",
            remedy="Begin the segment earlier, or the independent data later.",
        )
        raise at_setting(problem, file, "orders.start", "identification.start")
    return (
        segment(signals, start, min(end, later) - start, file),
        segment(signals, later, orders["length"], file, "orders"),
    )


def good_stretches(
    signals: store.Record, part: slice, file: Path, identification: Mapping[str, Any]
) -> tuple[list[Any], list[Any]]:
    """Return inputs and outputs of the stretches of ``part`` without a flagged sample.

    Raises
    ------
    InputError
        If none is long enough for the lags of ``identification``.
    """
    lags = {name: largest_lag(identification[name]) for name in ("y_lags", "u_lags")}
    largest = max(lags, key=lambda name: lags[name])
    try:
        found = stretches(np.isfinite(signals.y), part, lags[largest])
    except ShortPartError as error:
        raise at_setting(error, file, f"identification.{largest}") from error
    except InputError as error:
        raise error.at(file=file, field="quality") from error
    return [signals.u[each] for each in found], [signals.y[each] for each in found]


# Keys of the section that say where models come from and how; all others are of `select_terms`.
_OF_THE_STAGE = {"start", "length", "resamples"}
_OF_THE_SEARCH = {"search", "threshold", "rounds"}


def selection_arguments(identification: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of the section that :func:`dea.select_terms` takes."""
    own = _OF_THE_STAGE | _OF_THE_SEARCH
    arguments = {name: value for name, value in identification.items() if name not in own}
    return arguments | {"search": _search(identification)}


def _search(identification: Mapping[str, Any]) -> Any:
    from dea.narx import Forward, Orthogonal, Refined

    threshold = identification.get("threshold")
    match identification["search"]:
        case "refined":
            return Refined(threshold, identification["rounds"])
        case "forward":
            return Forward() if threshold is None else Forward(threshold, threshold)
        case "orthogonal":
            return Orthogonal()
        case other:
            raise ValueError(f"no search is called {other!r}")


def common_search(identification: Mapping[str, Any], own: Sequence[Any]) -> Any:
    """Return the refined search of a structure that several systems share.

    Where the section gives it no threshold, it is the median of those that the searches of their
    ``own`` models came to.
    """
    from dea.narx import Refined

    threshold = identification.get("threshold")
    if identification["search"] != "refined" or threshold is None:
        traces = [model.trace for model in own if model.trace is not None]
        reached = [float(trace["threshold"]) for trace in traces if "threshold" in trace]
        threshold = float(np.median(reached)) if reached else None
    return Refined(threshold, identification["rounds"])


def as_found(search: Any, model: Any) -> Any:
    """Return the settings of ``search`` with the threshold that it came to for ``model``."""
    trace = model.trace
    if trace is None or "threshold" not in trace:
        return search
    return replace(search, threshold=float(trace["threshold"]))
