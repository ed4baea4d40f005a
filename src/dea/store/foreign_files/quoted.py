"""Rows of a table of text, of which a quoted field may go on over several lines."""

import csv
from collections.abc import Callable, Sequence
from itertools import islice, takewhile


def joined(
    lines: Sequence[str], separator: str, is_row: Callable[[str], bool]
) -> tuple[list[str], list[int]]:
    """Return whole rows, their lines joined by a blank, and the index of the first line of each.

    Where a quote is not closed before the next line that ``is_row``, or the end, the row ends with
    its line.
    """
    rows: list[str] = []
    begins: list[int] = []
    i = 0
    while i < len(lines):
        end = i + _length(lines, i, separator, is_row)
        rows.append(" ".join(lines[i:end]))
        begins.append(i)
        i = end
    return rows, begins


def is_open(row: str, separator: str) -> bool:
    """Tell whether the last field of a row begins with a quote mark, and nothing closes it."""
    return '"' in row and _lines_read([row, ""], separator) == 2


def _length(lines: Sequence[str], at: int, separator: str, is_row: Callable[[str], bool]) -> int:
    """Return of how many lines the row consists that begins there."""
    if not is_open(lines[at], separator):
        return 1
    further = takewhile(lambda line: not is_row(line), islice(lines, at + 1, None))
    possible = [lines[at], *further]
    read = _lines_read([*possible, ""], separator)
    return read if read <= len(possible) else 1


def _lines_read(lines: Sequence[str], separator: str) -> int:
    """Return of how many of these lines the first row consists."""
    # Between spaces tabs separate too.
    plain = (line.replace("\t", " ") for line in lines) if separator == " " else lines
    reader = csv.reader(plain, delimiter=separator, skipinitialspace=True)
    next(reader)
    return reader.line_num
