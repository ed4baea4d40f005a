"""What a foreign file holds once it is read: columns of numbers, their units, lone numbers."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from dea.arrays import Array
from dea.errors import InputError
from dea.store.foreign_files.clock import is_day, is_time_of_day, joined, seconds
from dea.units import plain_units

# What instruments write where there is no number.
MISSING = ("", "nan", "na", "n/a", "null", "none", "-", "--", "inf", "-inf")
_HEADING = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<units>[^\])]*)[\])]$")
_FORTRAN = re.compile(r"(?<=[\d.,])[dD](?=[-+]?\d+\s*$)")
_THOUSANDS = re.compile(
    r"[-+]?\d{1,3}(?P<mark>[.,'’ \u00a0\u202f])\d{3}((?P=mark)\d{3})*((?!(?P=mark))[.,]\d*)?"
)
_DECIMALS = re.compile(r"[-+]?\d+[.,]\d+")  # a number, in a table with the other mark
_NO_NUMBERS = 9.9e37, 9.91e37  # infinity, and not a number
# Share of the entries of a column that must be numbers; the others count as missing.
_NUMERIC = 0.5


def _row(row: int) -> str:
    return f"row {row + 1}"


@dataclass(frozen=True)
class ForeignTable:
    """A file of another program.

    Parameters
    ----------
    columns
        One-dimensional numbers by name; NaN where there is none. Dates and times of day are
        seconds since the first, durations the seconds that they last.
    units
        Those that the file gives, by column or constant.
    constants
        Columns or variables of one number alone.
    words
        The first entry of a column that is text where others are numbers, and where it is; such an
        entry is NaN in the column.
    clocks
        Columns that were dates, times of day or durations.
    complex_numbers
        Columns that were complex, and are NaN throughout.
    no_numbers
        What other columns hold, in words: nothing, or text.
    place
        Where an entry is in the file, by its row.
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)
    clocks: tuple[str, ...] = ()
    complex_numbers: tuple[str, ...] = ()
    no_numbers: Mapping[str, str] = field(default_factory=dict)
    place: Callable[[int], str] = _row

    def refuse_words(self, names: Iterable[str], file: Path) -> None:
        """Refuse text among the numbers of the columns that are used, and complex ones.

        Raises
        ------
        InputError
            Naming the column, of text the entry and where it is.
        """
        for name in names:
            if name in self.complex_numbers:
                raise InputError(
                    "it is complex",
                    file=file,
                    field=f"column {name!r}",
                    remedy="Give its real part",
                )
            if name in self.words:
                raise InputError(
                    f"{self.words[name]} is not a number",
                    file=file,
                    field=f"column {name!r}",
                    remedy="Correct that entry, or empty it: it then counts as missing",
                )


def name_and_units(heading: str) -> tuple[str, str | None]:
    """Return the parts of a heading such as ``Temperature (degC)``, perhaps of several lines."""
    heading = _in_a_line(heading)
    found = _HEADING.match(heading)
    if found is None or not found["name"]:
        return heading, None
    return found["name"], plain_units(found["units"])


def _in_a_line(heading: str) -> str:
    return re.sub(r"\s*[\r\n]\s*", " ", heading.strip())


def from_columns(
    headings: Iterable[str],
    values: Iterable[pd.Series],
    given: Iterable[str | None] | None = None,
    *,
    decimal: str = ".",
    place: Callable[[int], str] = _row,
) -> ForeignTable:
    """Return the table of these columns, of which some may be text, and others empty.

    A column of dates and one of times of day are one time, by the name of the latter.

    Parameters
    ----------
    headings
        Names, with or without units in brackets; an empty one is the number of the column. A column
        that has none and holds nothing is none, where others have one.
    given
        Units of each column, where the file gives them apart from the heading.
    decimal
        Mark of the decimals in numbers that are text still.
    place
        Where an entry is in the file, by its row.

    Raises
    ------
    InputError
        Where two columns have one name.
    """
    given_names = [_in_a_line(heading) for heading in headings]
    whole = [name or f"column {i + 1}" for i, name in enumerate(given_names)]
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
    words: dict[str, str] = {}
    clocks: list[str] = []
    no_numbers: dict[str, str] = {}
    apart = list(given) if given is not None else [None] * len(names)
    for name, heading, (_, own), other, series in zip(
        names, given_names, parts, apart, _dated(values), strict=True
    ):
        if series is None:
            continue
        if not series.empty and not series.notna().any():
            if heading or not any(given_names):
                no_numbers[name] = "nothing"
            continue
        numbers, is_time = _numbers(series, decimal)
        if numbers is None:
            read = pd.to_numeric(series, errors="coerce").to_numpy(float)
            no_numbers[name] = f"text ({_first_word(series, read, place)})"
            continue
        if not is_time and (word := _first_word(series, numbers, place)) is not None:
            words[name] = word
        said = "s" if is_time else own or other
        if said is not None:
            units[name] = said
        there = np.flatnonzero(np.isfinite(numbers))
        if there.size == 1 and there[0] == 0 and numbers.size > 1:
            constants[name] = float(numbers[0])
            continue
        columns[name] = numbers
        clocks += [name] if is_time else []
    return ForeignTable(
        columns, units, constants, words, tuple(clocks), no_numbers=no_numbers, place=place
    )


def _dated(values: Iterable[pd.Series]) -> list[pd.Series | None]:
    """Return the columns, the only one of times of day with the dates of the only one of these.

    Those of dates become None.
    """
    columns: list[pd.Series | None] = list(values)
    days = [i for i, s in enumerate(columns) if s is not None and is_day(s)]
    times = [i for i, s in enumerate(columns) if s is not None and is_time_of_day(s)]
    if len(days) == len(times) == 1:
        day, time = days[0], times[0]
        whole = joined(columns[day], columns[time])
        if seconds(whole) is not None:
            columns[day], columns[time] = None, whole
    return columns


def _numbers(series: pd.Series, decimal: str) -> tuple[Array | None, bool]:
    """Return a column as numbers, None where it is text, and whether it tells the time."""
    dtype = series.dtype
    if pd.api.types.is_datetime64_any_dtype(dtype) or pd.api.types.is_timedelta64_dtype(dtype):
        return seconds(series), True
    if pd.api.types.is_numeric_dtype(series):
        return _without_marks(series.to_numpy(float)), False
    plain = series.map(lambda cell: _pointed(cell, decimal))
    read = pd.to_numeric(plain, errors="coerce").to_numpy(float)
    given = series.notna().to_numpy()
    if given.any() and np.isfinite(read)[given].mean() > _NUMERIC:
        return _without_marks(read), False
    told = seconds(series)
    return told, told is not None


def _without_marks(numbers: Array) -> Array:
    """Return numbers without those by which instruments say that there is none (SCPI 1999)."""
    return np.where(np.isin(np.abs(numbers), _NO_NUMBERS), np.nan, numbers)


def _pointed(cell: object, decimal: str) -> object:
    """Return a number that is written with another mark as one with a point.

    A power of ten may be written with D, as by Fortran.
    """
    if not isinstance(cell, str):
        return cell
    cell = _FORTRAN.sub("e", cell)
    if decimal == ".":
        return cell
    return None if "." in cell else cell.replace(decimal, ".")


def _first_word(series: pd.Series, numbers: Array, place: Callable[[int], str]) -> str | None:
    """Return the first entry that is text and no number, and where it is."""
    for row in np.flatnonzero(~np.isfinite(numbers) & series.notna().to_numpy()):
        cell = series.iloc[row]
        if isinstance(cell, str) and (word := cell.strip()).lower() not in MISSING:
            thousands = _THOUSANDS.fullmatch(word) and not _DECIMALS.fullmatch(word)
            marked = " with a mark of thousands" if thousands else ""
            return f"{place(int(row))}: {word!r}{marked}"
    return None
