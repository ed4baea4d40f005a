"""Tables of text as instruments write them: which character separates, where the numbers begin."""

import csv
import re
from collections.abc import Sequence
from io import StringIO
from itertools import product
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from dea.errors import InputError
from dea.store.foreign_files.clock import is_clock
from dea.store.foreign_files.headings import (
    LOOKED_AT,
    counts_columns,
    headings_and_units,
    is_data,
    is_number,
)
from dea.store.foreign_files.quoted import is_open, joined
from dea.store.foreign_files.table import MISSING, ForeignTable, from_columns

# str.splitlines splits at form feeds and separators of Unicode as well, which names may hold.
_LINE_END = re.compile(r"\r\n|\r|\n")
_COMMENTS = ("#", "%", "//", "!")
_SEPARATORS = ("\t", ";", ",", "|", " ")
_DECIMALS = (".", ",")


class Layout(NamedTuple):
    """How a text table is written; each row of a ``closed`` one ends with the separator."""

    separator: str
    decimal: str
    columns: int
    closed: bool


def read_text(file: Path) -> ForeignTable:
    """Read a table of text: tab, semicolon, comma, bar or spaces, decimal point or comma.

    Lines of comment, lines before the table, a line of units below the headings, headings within
    the last comment, quoted numbers, quoted fields of several lines, and a separator at the end of
    each line are understood. Where only some lines end with one, the last field of these is empty:
    a missing number.

    Raises
    ------
    InputError
        If no line holds two numbers, a line holds more or fewer than the table, a quote is not
        closed, or two columns have one name.
    """
    # A tab at the end of a line may separate an empty field.
    whole = [line.rstrip(" ") for line in _LINE_END.split(_decoded(file))]
    remarks, numbered = _without_comments(whole)
    rows = [whole[i] for i in numbered]
    layout = _layout(rows)
    if layout is None:
        raise InputError(
            "no line of it holds two numbers", file=file, remedy="Write it as a table of numbers"
        )
    rows, begins = joined(rows, layout.separator, lambda line: _is_like_a_row(line, layout))
    numbered = [numbered[i] for i in begins]
    begin = _first_row(rows, numbered, layout, file)
    # Above a last column in which there is nothing a heading may stand.
    widest = layout.columns + layout.closed
    above = _of_width(rows[:begin], layout, widest) or _of_width(remarks[-1:], layout, widest)
    first = [_fields(row, layout) for row in rows[begin : begin + 2]]
    if not above and len(first) == 2 and counts_columns(*first):
        above, begin = first[:1], begin + 1
    _check_rows(rows[begin:], numbered[begin:], layout, file)
    headings, units = headings_and_units(above, layout.columns)
    frame = pd.read_csv(
        StringIO("\n".join(rows[begin:])),
        sep=r"\s+" if layout.separator == " " else layout.separator,
        decimal=layout.decimal,
        header=None,
        names=range(layout.columns),
        index_col=False,
        skipinitialspace=True,
        na_values=list(MISSING),
        usecols=range(layout.columns),
    )
    return from_columns(
        headings,
        [frame[i] for i in frame.columns],
        units,
        decimal=layout.decimal,
        place=lambda row: f"line {numbered[begin + row] + 1}",
    )


def _first_row(rows: Sequence[str], numbered: Sequence[int], layout: Layout, file: Path) -> int:
    """Return which row is the first of the table.

    It is as wide as the table, or above such a one with words behind its last number.

    Raises
    ------
    InputError
        If there is none, or there are fewer numbers right above it: they are neither a row nor
        headings.
    """
    whole_rows = (i for i, row in enumerate(rows) if _is_row(_fields(row, layout), layout))
    begin = next(whole_rows, None)
    if begin is None:
        raise InputError(
            "in no line of it most fields are numbers",
            file=file,
            remedy="Write numbers alone below the headings, and units into these",
        )
    whole = _are_numbers(rows[begin], layout)
    while begin and _goes_on(rows[begin - 1], whole, layout):
        begin -= 1
    above = rows[begin - 1] if begin else ""
    fields = _fields(above, layout)
    # Dates alone say when the record was made.
    dates = all(is_clock(field) or field.lower() in MISSING for field in fields)
    if 1 < len(fields) < layout.columns and all(_are_numbers(above, layout)) and not dates:
        raise _narrow(numbered[begin - 1], len(fields), layout, file)
    return begin


def _goes_on(row: str, whole: Sequence[bool], layout: Layout) -> bool:
    """Tell whether a row is one of the table but for words at its end."""
    fields = _pointed(_fields(row, layout), layout.decimal)
    words = fields[layout.columns :]
    return (
        is_data(fields[: layout.columns])
        and _are_numbers(row, layout)[: layout.columns] == whole
        and any(words)
        and not any(map(is_number, words))
    )


def _check_rows(rows: Sequence[str], numbered: Sequence[int], layout: Layout, file: Path) -> None:
    """Refuse the first row whose fields are not certain.

    That is one with a quote mark that would take the rows below it for text, one of more numbers
    than the table has columns, and between spaces one that does not say which number is missing.

    Raises
    ------
    InputError
        Naming the line.
    """
    spaced = layout.separator == " "
    whole = _are_numbers(rows[0], layout)[: layout.columns]
    for row, number in zip(rows, numbered, strict=True):
        if is_open(row, layout.separator):
            raise InputError(
                f"line {number + 1} begins a field with a quote mark that is not closed before the"
                " next row",
                file=file,
                remedy="Close the quote, or delete its mark",
            )
        # Counting is quick, and there is nothing to split in nearly every row.
        if not spaced and row.count(layout.separator) < layout.columns:
            continue
        fields = _fields(row, layout)
        if any(map(is_number, _pointed(fields[layout.columns :], layout.decimal))):
            remedy = "Correct it; a number with a mark of thousands is to be quoted"
            raise _of_other_width(number, len(fields), layout, file, remedy)
        if spaced and _lacks_some(row, fields, whole, layout):
            raise _narrow(number, len(fields), layout, file)


def _lacks_some(row: str, fields: Sequence[str], whole: Sequence[bool], layout: Layout) -> bool:
    """Tell whether a row of numbers between spaces lacks some of those that are in the first row.

    Where all that the first row has more are words at its end, it lacks none.
    """
    lacking = layout.columns - len(fields)
    if lacking <= 0 or not is_data(_pointed(fields, layout.decimal)):
        return False
    return [*_are_numbers(row, layout), *[False] * lacking] != whole


def _narrow(number: int, fields: int, layout: Layout, file: Path) -> InputError:
    remedy = "Write nan in the place of what is missing, or delete the line"
    return _of_other_width(number, fields, layout, file, remedy)


def _of_other_width(
    number: int, fields: int, layout: Layout, file: Path, remedy: str
) -> InputError:
    return InputError(
        f"line {number + 1} has {fields} fields, and the table {layout.columns}",
        file=file,
        remedy=remedy,
    )


def _are_numbers(row: str, layout: Layout) -> list[bool]:
    """Tell which fields of a row are numbers or marks of missing ones."""
    fields = _pointed(_fields(row, layout), layout.decimal)
    return [is_number(field) or field.lower() in MISSING for field in fields]


def _decoded(file: Path) -> str:
    content = file.read_bytes()
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16")
    if b"\0" in content[:2]:
        order = "be" if content[:1] == b"\0" else "le"
        return content.decode(f"utf-16-{order}", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _without_comments(lines: Sequence[str]) -> tuple[list[str], list[int]]:
    """Return the comments before the first row, their marks taken off, and which lines are rows."""
    remarks: list[str] = []
    rows: list[int] = []
    for i, line in enumerate(lines):
        if not line.strip():
            continue
        if not line.lstrip().startswith(_COMMENTS):
            rows.append(i)
        elif not rows:
            remarks.append(line.lstrip().lstrip("#%/!").strip())
    return remarks, rows


def _layout(rows: Sequence[str]) -> Layout | None:
    """Return the layout under which most fields of the last rows looked at are numbers."""
    looked_at = rows[:LOOKED_AT]
    begin = len(looked_at) // 2
    sample = looked_at[begin:]
    best, most = None, 0.0
    for separator, decimal in product(_SEPARATORS, _DECIMALS):
        # Numbers with the mark that separates them are quoted.
        if separator == decimal and not any('"' in row for row in sample):
            continue
        # The last column may be empty throughout the sample, and hold numbers further on.
        closed = separator != " " and all(row.endswith(separator) for row in rows[begin:])
        split = [_fields(row, Layout(separator, decimal, 0, closed)) for row in sample]
        counts = [len(row) for row in split]
        columns = max(set(counts), key=counts.count) if counts else 0
        if columns < 2:
            continue
        fields = [field for row in split if len(row) == columns for field in row]
        numeric = sum(map(is_number, _pointed(fields, decimal))) + 0.5 * sum(
            field.lower() in MISSING for field in fields
        )
        share = numeric / len(fields) * counts.count(columns) / len(counts)
        if share > most + 1e-9:
            best, most = Layout(separator, decimal, columns, closed), share
    return best if most > 0.3 else None


def _fields(row: str, layout: Layout) -> list[str]:
    if layout.separator == " ":
        # The table has tabs as well, so that a row that ends in one has an empty last column.
        return [*row.split(), ""] if row.endswith("\t") else row.split()
    fields = next(csv.reader([row], delimiter=layout.separator, skipinitialspace=True), [])
    stripped = [field.strip() for field in fields]
    ended = layout.closed and len(stripped) > 2 and not stripped[-1]
    return stripped[:-1] if ended else stripped


def _of_width(rows: Sequence[str], layout: Layout, widest: int) -> list[list[str]]:
    """Return the fields of the rows that are as wide as the table; others are no headings.

    One field less leaves the last one empty. A spreadsheet pads rows to the width of its widest:
    empty fields beyond the ``widest`` are passed over.
    """
    fields = (_fields(row, layout) for row in rows)
    near = (row for row in fields if layout.columns - 1 <= len(row) and not any(row[widest:]))
    return [[*row, ""][: layout.columns] for row in near]


def _pointed(fields: Sequence[str], decimal: str) -> list[str]:
    if decimal == ".":
        return list(fields)
    return ["x" if "." in field else field.replace(",", ".") for field in fields]


def _is_row(fields: Sequence[str], layout: Layout) -> bool:
    return len(fields) == layout.columns and is_data(_pointed(fields, layout.decimal))


def _is_like_a_row(line: str, layout: Layout) -> bool:
    """Tell whether a line, whole or not as wide as the table, holds the numbers of a row."""
    fields = _fields(line, layout)
    return len(fields) > 1 and is_data(_pointed(fields[: layout.columns], layout.decimal))
