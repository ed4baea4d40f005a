"""What a foreign file holds once it is read: columns of numbers, their units, lone numbers."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dea.errors import InputError
from dea.store.foreign_files.clock import seconds

Array = NDArray[np.float64]

_HEADING = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<units>[^\])]*)[\])]$")
_SPELLINGS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "millisecond": "ms",
    "milliseconds": "ms", "µs": "us", "μs": "us", "usec": "us", "minute": "min", "minutes": "min",
    "hour": "h", "hours": "h", "hr": "h", "volt": "V", "volts": "V", "-": "1", "": "1",
}  # fmt: skip
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
# Share of the entries of a column that must be numbers; the others count as missing.
_NUMERIC = 0.5


@dataclass(frozen=True)
class ForeignTable:
    """A file of another program.

    Parameters
    ----------
    columns
        One-dimensional numbers by name; NaN where there is none. Dates and times of day are
        seconds since the first.
    units
        Those that the file gives, by column.
    constants
        Columns or variables of one number alone.
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)


def time_factor(units: str) -> float | None:
    """Return how many seconds a unit of time has; None for other units."""
    return _SECONDS.get(units)


def plain_units(text: str) -> str:
    """Return units in the spelling of this project: ``(sec)`` is ``s``."""
    bare = text.strip().strip("[]()").strip()
    if bare.lower().startswith("seconds since"):
        return "s"
    return _SPELLINGS.get(bare.lower(), bare.replace("µ", "u").replace("μ", "u"))


def name_and_units(heading: str) -> tuple[str, str | None]:
    """Return the parts of a heading such as ``Temperature (degC)``."""
    found = _HEADING.match(heading.strip())
    if found is None or not found["name"]:
        return heading.strip(), None
    return found["name"], plain_units(found["units"])


def from_columns(
    headings: Iterable[str], values: Iterable[pd.Series], given: Iterable[str | None] | None = None
) -> ForeignTable:
    """Return the table of these columns, of which some may be text.

    Parameters
    ----------
    headings
        Names, with or without units in brackets.
    given
        Units of each column, where the file gives them apart from the heading.

    Raises
    ------
    InputError
        Where two columns have one name.
    """
    whole = [heading.strip() for heading in headings]
    parts = [name_and_units(heading) for heading in whole]
    bare = [name for name, _ in parts]
    names = [n if bare.count(n) == 1 else full for n, full in zip(bare, whole, strict=True)]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(
            f"two columns are called {twice[0]!r}", remedy="Give each column a name of its own"
        )
    columns: dict[str, Array] = {}
    units: dict[str, str] = {}
    constants: dict[str, float] = {}
    apart = list(given) if given is not None else [None] * len(names)
    for name, (_, own), other, series in zip(names, parts, apart, values, strict=True):
        numbers, is_time = _numbers(series)
        if numbers is None:
            continue
        there = np.flatnonzero(np.isfinite(numbers))
        if there.size == 1 and there[0] == 0 and numbers.size > 1:
            constants[name] = float(numbers[0])
            continue
        columns[name] = numbers
        said = "s" if is_time else own or other
        if said is not None:
            units[name] = said
    return ForeignTable(columns, units, constants)


def _numbers(series: pd.Series) -> tuple[Array | None, bool]:
    """Return a column as numbers, None where it is text, and whether it tells the time."""
    if pd.api.types.is_datetime64_any_dtype(series):
        return seconds(series), True
    if pd.api.types.is_numeric_dtype(series):
        return series.to_numpy(float), False
    read = pd.to_numeric(series, errors="coerce").to_numpy(float)
    given = series.notna().to_numpy()
    if given.any() and np.isfinite(read)[given].mean() > _NUMERIC:
        return read, False
    told = seconds(series)
    return told, told is not None
