"""Which column of a table tells the time: by its name, as dates, or by its units."""

import re
from collections.abc import Sequence

import numpy as np

from dea.arrays import Array
from dea.store.foreign_files.table import ForeignTable
from dea.units import SECONDS, plain_units

# Whole words of a name. Those that are all of it are certain, but for a date, which may be that of
# the day alone. A "t" within a longer name is more often a temperature or a torque.
_SURE = {
    "time", "times", "timestamp", "datetime", "zeit", "uhrzeit", "clock", "millis", "micros",
}  # fmt: skip
_WORDS = {*_SURE, "date"}


def time_column(table: ForeignTable) -> str | None:
    """Return the column that is the time by its name, as dates, or the first one by its units."""
    name = called_time(table)
    return name if name is not None and _ascends(table.columns[name]) else None


def called_time(table: ForeignTable) -> str | None:
    """Return the likeliest column: by its whole name, dates, a word of its name, units.

    One with units of time beside its name comes first; one that is constant is none.
    """
    possible = [
        name
        for name, values in table.columns.items()
        if table.units.get(name, "s") in SECONDS and _changes(values)
    ]
    whole = [name for name in possible if _is_whole(name)]
    lone = [name for name in possible if _words(name) == ["t"]]
    small = [name for name in lone if name.strip().startswith("t")]
    clocks = [name for name in possible if name in table.clocks]
    certain = [*_with_units([*whole, *lone], table), *whole, *clocks, *small]
    if certain:
        return certain[0]
    longer = [name for name in possible if _WORDS.intersection(_parts(name))]
    first = [name for name in list(table.columns)[:1] if table.units.get(name) in SECONDS]
    likely = [*_with_units(longer, table), *longer, *first, *lone]
    return next((n for n in likely if _ascends(table.columns[n])), next(iter(likely), None))


def units_in_name(name: str) -> str | None:
    """Return the units of a time of which the last word of its name tells: ``time_ms``."""
    units = plain_units(_parts(name)[-1])
    return units if units in SECONDS else None


def _with_units(names: Sequence[str], table: ForeignTable) -> list[str]:
    return [name for name in names if name in table.units or units_in_name(name)]


def _is_whole(name: str) -> bool:
    """Tell whether a name says time and nothing else but its unit."""
    words = set(_words(name))
    return words <= _WORDS and bool(words & _SURE)


def _words(name: str) -> list[str]:
    """Return the words of a name without a unit of time behind them: those of ``t_ms``, ``t``."""
    words = list(filter(None, _parts(name)))
    return words[:-1] if len(words) > 1 and units_in_name(name) else words


def _parts(name: str) -> list[str]:
    return re.split(r"[^a-z0-9]+", name.lower())


def _changes(values: Array) -> bool:
    there = values[np.isfinite(values)]
    return there.size > 0 and bool(np.ptp(there) > 0)


def _ascends(values: Array) -> bool:
    there = values[np.isfinite(values)]
    return there.size > 2 and bool(np.all(np.diff(there) >= 0)) and bool(there[-1] > there[0])
