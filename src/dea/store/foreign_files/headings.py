"""Where the numbers of a table begin, and which of the rows above them name its columns."""

import re
from collections.abc import Sequence

from dea.store.foreign_files.clock import is_clock
from dea.store.foreign_files.table import MISSING, name_and_units
from dea.units import plain_units

_NUMBER = re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?$")
LOOKED_AT = 400  # rows among which the numbers must have begun
_LONGEST_UNITS = 12  # characters


def is_number(field: str) -> bool:
    """Tell whether a field is a number with a decimal point, or a date or time of day."""
    return bool(_NUMBER.match(field)) or is_clock(field)


def is_data(fields: Sequence[str]) -> bool:
    """Tell whether most of a row is numbers, or marks of missing ones beside a number."""
    numbers = sum(map(is_number, fields))
    empty = sum(field.lower() in MISSING for field in fields)
    return numbers > 0 and numbers + empty > len(fields) / 2


def counts_columns(fields: Sequence[str], below: Sequence[str]) -> bool:
    """Tell whether a row holds 0, 1, 2 and so on: what pandas writes for want of headings.

    Beside an index its first field is empty. Two such numbers above integers are a sample.
    """
    counted = list(fields[1:] if fields[:1] == [""] else fields)
    integers = all(field.isdigit() for field in below)
    return counted == list(map(str, range(len(counted)))) and not (len(fields) < 3 and integers)


def headings_and_units(
    above: Sequence[Sequence[str]], columns: int
) -> tuple[list[str], list[str | None] | None]:
    """Return the headings, empty ones where there are none, and the units below them.

    Parameters
    ----------
    above
        Rows above the numbers, each as wide as the table. A title, or a remark, fills fewer of its
        fields than the headings do, where a spreadsheet has padded it to that width. Headings with
        units in brackets have no row of units below them.
    """
    if not above:
        return [""] * columns, None
    *_, last = above
    with_units = (
        len(above) > 1
        and _filled(above[-2]) >= _filled(last)
        and all(map(_is_short, last))
        and not _has_units(last)
    )
    names = above[-2] if with_units else last
    return list(names), [plain_units(field) for field in last] if with_units else None


def _filled(row: Sequence[str]) -> int:
    return sum(map(bool, row))


def _has_units(row: Sequence[str]) -> bool:
    """Tell whether most fields end with units in brackets, as few units do: ``V (rms)``."""
    return 2 * sum(name_and_units(field)[1] is not None for field in row) > _filled(row)


def _is_short(field: str) -> bool:
    return len(field) <= _LONGEST_UNITS
