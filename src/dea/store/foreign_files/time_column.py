"""Which column of a table tells the time: by its name, as dates, or by its units."""

import re

import numpy as np

from dea.arrays import Array
from dea.store.foreign_files.table import ForeignTable
from dea.units import SECONDS, plain_units

# Whole words of a name. A "t" within a longer name is more often a temperature or a torque.
_WORDS = {
    "time", "times", "timestamp", "date", "datetime", "zeit", "uhrzeit", "clock", "millis",
    "micros",
}  # fmt: skip


def time_column(table: ForeignTable) -> str | None:
    """Return the column that is the time by its name, as dates, or the first one by its units."""
    name = called_time(table)
    return name if name is not None and _ascends(table.columns[name]) else None


def called_time(table: ForeignTable) -> str | None:
    """Return the likeliest column: units of time beside its name, then the name, dates, units."""
    possible = [name for name in table.columns if table.units.get(name, "s") in SECONDS]
    named = [name for name in possible if _WORDS.intersection(_parts(name))]
    lone = list(filter(_is_t, possible))
    sure = [name for name in (*named, *lone) if name in table.units or units_in_name(name)]
    first = [name for name in list(table.columns)[:1] if table.units.get(name) in SECONDS]
    return next(iter((*sure, *named, *table.clocks, *first, *lone)), None)


def units_in_name(name: str) -> str | None:
    """Return the units of a time of which the last word of its name tells: ``time_ms``."""
    units = plain_units(_parts(name)[-1])
    return units if units in SECONDS else None


def _is_t(name: str) -> bool:
    """Tell whether a name is ``t``, with nothing behind it but a unit of time: ``t_ms``."""
    parts = _parts(name.strip())
    return parts[0] == "t" and (len(parts) == 1 or (len(parts) == 2 and bool(units_in_name(name))))


def _parts(name: str) -> list[str]:
    return re.split(r"[^a-z0-9]+", name.lower())


def _ascends(values: Array) -> bool:
    there = values[np.isfinite(values)]
    return there.size > 2 and bool(np.all(np.diff(there) >= 0)) and bool(there[-1] > there[0])
