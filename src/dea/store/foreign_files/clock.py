"""Columns of dates and of times of day, as seconds since the first, and of durations."""

import re
from collections.abc import Callable, Iterable, Iterator
from itertools import islice

import numpy as np
import pandas as pd
from numpy.typing import NDArray

DAY, _HOUR = 86_400.0, 3600.0
_CLOCK = re.compile(r"^(\d{1,3}):(\d{2}):(\d{2}(?:[.,]\d*)?)(?:\s*([AP])M)?$", re.IGNORECASE)
# As a spreadsheet shows times below a second.
_MINUTES = re.compile(r"^(\d{1,3}):(\d{2}[.,]\d+)$")
_DATE = re.compile(r"^\d{1,4}[-./]\d{1,2}[-./]\d{1,4}$")
# As people write dates; what is tried first is ISO 8601.
_FORMATS = "ISO8601", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M:%S.%f", "%d.%m.%Y %H:%M"
# A text may be read by several of these.
_SLASHED = ("%m/%d/%Y %H:%M:%S", "%m/%d/%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S %p",
            "%m/%d/%Y %I:%M:%S.%f %p", "%m/%d/%Y %H:%M", "%m/%d/%Y %I:%M %p",
            "%d/%m/%Y %H:%M:%S", "%d/%m/%Y %H:%M:%S.%f", "%d/%m/%Y %H:%M")  # fmt: skip


def is_clock(text: str) -> bool:
    """Tell whether a field holds a time of day, or in an hour, or begins with a date."""
    of_day = _CLOCK.match(text) or _MINUTES.match(text)
    return bool(of_day or re.match(r"^\d{1,4}[-./]\d{1,2}[-./]\d{1,4}(\D|$)", text))


def seconds(column: pd.Series) -> NDArray[np.float64] | None:
    """Return seconds since the first entry, NaN where there is none; None where it is no time.

    Durations are the seconds that they last.

    A time of day that falls back has passed midnight, minutes and seconds the full hour. Where a
    date may begin with the day or with the month, the reading whose longest step is shorter is
    taken: days follow each other, not months.
    """
    if pd.api.types.is_datetime64_any_dtype(column):
        return _since_first(column)
    if pd.api.types.is_timedelta64_dtype(column):
        return np.asarray(column.dt.total_seconds().to_numpy(), float)
    given = column.dropna().astype(str).str.strip()
    given = given[given != ""]
    if given.empty:
        return None
    texts, there = column.astype(str).str.strip(), column.notna().to_numpy()
    if all(map(_CLOCK.match, given)):
        return _passed(texts, there, _of_day, DAY)
    if all(map(_MINUTES.match, given)):
        return _passed(texts, there, _of_hour, _HOUR)
    if not is_clock(given.iloc[0]):
        return None
    pointed = given.str.replace(",", ".")
    readings = list(islice(_readings(pointed, _FORMATS), 1)) or list(_readings(pointed, _SLASHED))
    if not readings:
        return None
    likeliest = min(readings, key=lambda read: read.diff().max())
    return _since_first(likeliest.reindex(column.index))


def is_day(column: pd.Series) -> bool:
    """Tell whether a column holds dates without a time of day."""
    if pd.api.types.is_datetime64_any_dtype(column):
        return bool(
            column.notna().any() and (column.dropna() == column.dropna().dt.floor("D")).all()
        )
    return _all_match(_DATE, column)


def is_time_of_day(column: pd.Series) -> bool:
    """Tell whether a column holds times of day without a date."""
    return _all_match(_CLOCK, column)


def joined(days: pd.Series, times: pd.Series) -> pd.Series:
    """Return the dates of one column with the times of day of another."""
    if pd.api.types.is_datetime64_any_dtype(days):
        days = days.dt.strftime("%Y-%m-%d")
    both = days.notna() & times.notna()
    return (days.astype(str).str.strip() + " " + times.astype(str).str.strip()).where(both)


def _all_match(pattern: re.Pattern[str], column: pd.Series) -> bool:
    if not pd.api.types.is_object_dtype(column) and not pd.api.types.is_string_dtype(column):
        return False
    given = (str(each).strip() for each in column.dropna())
    return bool(column.notna().any()) and all(map(pattern.match, given))


def _readings(given: pd.Series, formats: Iterable[str]) -> Iterator[pd.Series]:
    """Yield what a column of dates is by each format by which it can be read and ascends."""
    for form in formats:
        read = pd.to_datetime(given, format=form, errors="coerce", utc=True)
        if read.notna().all() and read.is_monotonic_increasing:
            yield read


def _since_first(times: pd.Series) -> NDArray[np.float64]:
    passed = times - times[times.first_valid_index()]
    return np.asarray(passed.dt.total_seconds().to_numpy(), float)


def _passed(
    texts: pd.Series, there: NDArray[np.bool_], read: Callable[[str], float], period: float
) -> NDArray[np.float64]:
    """Return seconds since the first of times that begin anew after a ``period`` in seconds."""
    told = np.full(texts.size, np.nan)
    told[there] = [read(text) for text in texts[there]]
    known = np.flatnonzero(np.isfinite(told))
    begun = np.cumsum(np.diff(told[known], prepend=told[known[0]]) < -period / 2)
    told[known] += period * begun - told[known[0]]
    return told


def _of_day(text: str) -> float:
    found = _CLOCK.match(text)
    if found is None:
        return np.nan
    hours, minutes, rest, half = found.groups()
    hour = int(hours) if half is None else int(hours) % 12 + 12 * (half in "Pp")
    return 3600 * hour + 60 * int(minutes) + float(rest.replace(",", "."))


def _of_hour(text: str) -> float:
    found = _MINUTES.match(text)
    if found is None:
        return np.nan
    return 60 * int(found[1]) + float(found[2].replace(",", "."))
