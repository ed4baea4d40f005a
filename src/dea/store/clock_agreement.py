"""Whether the interval that is given for a record is that of the times in its file."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.store.foreign_files import ForeignTable, time_column, units_in_name
from dea.store.resampling import rounding
from dea.units import SECONDS

_APART = 0.01  # share by which intervals may differ
_NEIGHBOURS = 50  # samples on either side, by whose times one that is late is told from a gap
_LOOKED_AT = 20  # longest steps
_GAP = 0.6  # intervals by which all later samples are late where one is missing


def require_interval(
    table: ForeignTable,
    named: Sequence[str],
    rows: Sequence[int] | None,
    interval: float,
    file: Path,
) -> None:
    """Refuse an interval in s that a column of times contradicts, and one that would close a gap.

    Times that do not tell the samples apart contradict nothing, nor do numbers of samples. Those
    without units may be in any.

    Parameters
    ----------
    named
        Columns that are input and output.
    rows
        First row that is read, and one past the last.

    Raises
    ------
    InputError
        Naming what the times say, and the setting that takes them.
    """
    size = table.columns[named[0]].size
    others = {n: c for n, c in table.columns.items() if n not in named and c.size == size}
    name = time_column(replace(table, columns=others))
    if name is None:
        return
    time = others[name][slice(*rows) if rows else slice(None)]
    at = np.flatnonzero(np.isfinite(time))
    own = _interval(at, time[at])
    units = table.units.get(name) or units_in_name(name)
    if own is None or (units is None and np.all(np.diff(time[at]) == 1.0)):
        return
    apart = max(_APART, 2.0 / at.size)
    fitting = [
        each
        for each in ([units] if units else SECONDS)
        if abs(own * SECONDS[each] / interval - 1.0) <= apart
    ]
    told = units or (fitting[0] if fitting else "…")
    remedy = f"time={{'column': {name!r}, 'units': {told!r}}} in its place"
    wrong = "; where those times are wrong, take the signals alone: dea.Record.of"
    if not fitting:
        said = f"says {own * SECONDS[units]:.4g} s" if units else f"has steps of {own:.4g}"
        raise InputError(
            f"it is {interval:g} s, and column {name!r} {said}",
            file=file,
            field="sampling_interval",
            remedy=f"Correct it, or give {remedy}{wrong}",
        )
    if (gap := _gap(at, time[at], own)) is not None:
        sample, lasting = gap
        raise InputError(
            f"column {name!r} has a gap of {lasting * SECONDS[told]:.4g} s after sample {sample}",
            file=file,
            field="sampling_interval",
            remedy=f"Give {remedy}, and resample={interval:g}: what is missing is flagged{wrong}",
        )


def _interval(at: NDArray[np.intp], time: Array) -> float | None:
    """Return the time between samples, None where times do not tell them apart.

    Parameters
    ----------
    at
        Which samples have a time.
    """
    if time.size < 3:
        return None
    if (rounded := rounding(time)) is not None:
        return 1.0 / rounded.rate
    if np.any(np.diff(time) <= 0):
        return None
    # Over several samples, so that neither jitter nor times that come in bursts shift it.
    several = min(_NEIGHBOURS, time.size // 4 + 1)
    return float(np.median((time[several:] - time[:-several]) / (at[several:] - at[:-several])))


def _gap(at: NDArray[np.intp], time: Array, interval: float) -> tuple[int, float] | None:
    """Return after which sample others are missing, and how long the step is; None without any."""
    if rounding(time) is not None:
        return None
    off = time - interval * at
    late = np.diff(off)
    for k in np.argsort(late)[::-1][:_LOOKED_AT]:
        before = off[max(k + 1 - _NEIGHBOURS, 0) : k + 1]
        after = off[k + 1 : k + 1 + _NEIGHBOURS]
        if min(late[k], np.median(after) - np.median(before)) > _GAP * interval:
            return int(at[k]), float(time[k + 1] - time[k])
    return None
