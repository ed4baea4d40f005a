"""Which column of a file holds the times of its samples, or how far apart these are."""

from pathlib import Path

import numpy as np

from dea import store
from dea.configuration.record import RecordFile
from dea.errors import InputError
from dea.intake.names import ColumnUnits, named
from dea.intake.questions import KEPT, answer
from dea.store import ForeignTable
from dea.units import HERTZ, SECONDS

_INTERVAL = {"ts", "dt", "tsample", "sampling_interval", "sample_time"}
_RATE = {"fs", "rate", "sampling_rate", "samplerate", "sample_rate"}
# Steps of times without units, in s where they are taken to be in s. Whole numbers that are further
# apart than one may as well be milliseconds.
_FINEST, _COARSEST = 1e-6, 10.0
_LATEST = 1e11  # s since 1970: clocks that count milliseconds or less are beyond it


def find_times(
    table: ForeignTable,
    said: ColumnUnits | None,
    earlier: ColumnUnits | None,
    rate: float | None,
    kept: RecordFile | None,
    file: Path,
    inferred: list[str],
) -> tuple[ColumnUnits | None, float | None, str | None]:
    """Return the time column with its units, the interval in s, and the column called the time.

    Units are None where only the user knows them; there may be neither column nor interval. What is
    inferred is added to the list.

    Parameters
    ----------
    said, rate
        Time column, and samples per second, that the user names.
    earlier, kept
        Time column of an earlier case of the same file, and all that it says of the record.

    Raises
    ------
    InputError
        If the times fall back, or the column that the user names is in other units.
    """
    of_the_case = rate is None and said is None and kept is not None
    if kept is not None and of_the_case and kept.sampling_interval is not None:
        rate = 1.0 / kept.sampling_interval
    known = said or earlier
    if said is None:
        _refuse_falling_time(
            table, known[0] if known else store.called_time(table), rate, file, inferred
        )
    time, interval = _timing(table, known, rate, inferred, file)
    clock = known[0] if known else store.time_column(table)
    if rate is not None and (clock is not None or of_the_case):
        unused = f"; column {clock!r} is not used" if clock is not None else ""
        of_case = f"{KEPT}{_otherwise(table, rate)}" if of_the_case else ""
        inferred.append(f"time: {rate:g} samples per second{of_case}{unused}")
    elif time is not None and earlier is not None:
        inferred.append(f"time: column {time[0]!r}, in {time[1]}{KEPT}")
    return time, interval, clock


def _timing(
    table: ForeignTable,
    said: ColumnUnits | None,
    rate: float | None,
    inferred: list[str],
    file: Path,
) -> tuple[ColumnUnits | None, float | None]:
    """Return the time column with its units, None where only the user knows them, or the interval.

    The interval is in s; there may be neither.

    Raises
    ------
    InputError
        If the column that the user names is in other units.
    """
    if rate is not None:
        return None, 1.0 / rate
    name, units = said or (store.time_column(table), None)
    if name is not None:
        units = units or table.units.get(name) or store.units_in_name(name)
        if units is None and not _may_be_seconds(table.columns[name]):
            return (name, None), None
        if units is None:
            other = answer("TIME", f"{name}:ms")
            inferred.append(f"time: column {name!r}, taken to be in s; if it is in ms, {other}")
        elif said is None:
            inferred.append(f"time: column {name!r}, in {units}")
        if (units or "s") in SECONDS:
            return (name, units or "s"), None
        if said is not None:
            raise InputError(
                f"{units!r} is no unit of time",
                file=file,
                field="TIME",
                remedy=f"Units of time are {', '.join(SECONDS)}; or give the samples per second,"
                " RATE=…",
            )
    if (stated := _stated_interval(table)) is not None:
        constant, interval = stated
        inferred.append(f"{interval:g} s between samples, from {constant!r}")
        return None, interval
    return None, None


def _may_be_seconds(values: np.ndarray) -> bool:
    """Tell whether times without units are likely to be in s, if they ascend at all."""
    there = values[np.isfinite(values)]
    steps = np.diff(there)
    if not np.any(steps > 0):
        return True
    most = 1.0 if np.all(there == np.round(there)) else _COARSEST
    likely = _FINEST <= np.median(steps[steps > 0]) <= most
    return bool(likely and np.all(np.abs(there) < _LATEST))


def _stated_interval(table: ForeignTable) -> tuple[str, float] | None:
    """Return the lone number that is the interval or the rate, and the interval in s."""
    for known, plain, scale in ((_INTERVAL, "s", SECONDS), (_RATE, "Hz", HERTZ)):
        constant = next(filter(named(known), table.constants), None)
        factor = scale.get(table.units.get(constant, plain)) if constant is not None else None
        if constant is not None and factor and table.constants[constant] > 0:
            value = factor * table.constants[constant]
            return constant, value if scale is SECONDS else 1.0 / value
    return None


def _refuse_falling_time(
    table: ForeignTable, name: str | None, rate: float | None, file: Path, inferred: list[str]
) -> None:
    """Refuse a column that is taken for the time and falls back, unless a rate is given.

    Records that were joined fall back, and one that was sorted the other way round.

    Raises
    ------
    InputError
        Naming the first sample at fault.
    """
    if name is None:
        return
    time = table.columns[name]
    there = np.flatnonzero(np.isfinite(time))
    back = np.flatnonzero(np.diff(time[there]) < 0)
    if not back.size:
        return
    before, at = there[back[0]], there[back[0] + 1]
    told = f"sample {at} is at {time[at]:g}, sample {before} at {time[before]:g}"
    if rate is not None:
        inferred.append(f"time: column {name!r} falls back ({told})")
        return
    raise InputError(
        f"it falls back: {told}",
        file=file,
        field=f"column {name!r}",
        remedy="Give each run a file of its own, or the samples per second if they follow each"
        " other without a break: RATE=…",
    )


def _otherwise(table: ForeignTable, rate: float) -> str:
    """Say where the file itself holds another interval than the case: it may be recorded anew."""
    stated = _stated_interval(table)
    if stated is None or np.isclose(stated[1] * rate, 1.0, rtol=1e-6):
        return ""
    return f", though {stated[0]!r} says {1.0 / stated[1]:g}"
