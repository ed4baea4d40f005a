"""Numbers that the documents quote from results, each between two comments.

``<!--= ADDRESS -->39<!--/-->`` quotes the number at ADDRESS, whose parts are separated by
semicolons:

* ``results/tables/NAME.csv; COLUMN; ROWS; HOW``: ROWS are conditions ``COLUMN=VALUE`` joined by
  ``&``;
* ``results/PATH.json; KEY; HOW`` and ``NAME; KEY; HOW`` of a stored campaign, which is
  ``docs/measured/NAME.json``: KEY has dots between its parts.

HOW holds, each where it is wanted: ``min``, ``max``, ``median`` or ``sum`` of the finite numbers or
``count`` of the rows, a factor such as ``x1000``, and a Python format such as ``.1f``. A list of
lines is quoted as they are.
"""

import csv
import json
import re
import statistics
from collections.abc import Callable, Collection, Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from dea import provenance
from dea.errors import InputError

CAMPAIGNS = Path("docs/measured")
_MARK = re.compile(r"(<!--= (?P<address>[^>]*?) -->)(?P<text>.*?)(<!--/-->)", re.DOTALL)
_REDUCED: dict[str, Callable[[Sequence[float]], float]] = {
    "min": min,
    "max": max,
    "median": statistics.median,
    "sum": sum,
}


class Quotation(NamedTuple):
    """A number in a document: where it stands (``line`` from 1), whence it is, what is printed."""

    document: Path
    line: int
    address: str
    text: str

    @property
    def source(self) -> Path:
        """The file that it is quoted from."""
        return source(self.address)

    @property
    def sentence(self) -> str:
        """The line that holds it, without the comments."""
        line = self.document.read_text(encoding="utf-8").splitlines()[self.line - 1]
        return re.sub(r"<!--.*?-->", "", line).strip()


def documents() -> list[Path]:
    """Return the documents that may quote results."""
    found = [Path("README.md"), *sorted(Path("docs").rglob("*.md"))]
    return [document for document in found if document.exists()]


def quotations() -> Iterator[Quotation]:
    """Yield every quotation of the documents."""
    for document in documents():
        content = document.read_text(encoding="utf-8")
        for mark in _MARK.finditer(content):
            line = content.count("\n", 0, mark.start()) + 1
            yield Quotation(document, line, " ".join(mark["address"].split()), mark["text"])


def resting(paths: Collection[str]) -> list[str]:
    """Return each line of the documents that quotes one of these files, with its place."""
    lines = {
        f"{one.document}:{one.line}: {one.sentence}"
        for one in quotations()
        if str(one.source) in paths
    }
    return sorted(lines)


def replaced(content: str, text: Callable[[str], str]) -> str:
    """Return a document with ``text(address)`` for each quotation."""

    def render(mark: re.Match[str]) -> str:
        return f"{mark[1]}{text(' '.join(mark['address'].split()))}{mark[4]}"

    return _MARK.sub(render, content)


def source(address: str) -> Path:
    """Return the file that an address names."""
    name = address.partition(";")[0].strip()
    file = Path(name)
    return file if file.is_relative_to(provenance.RESULTS) else CAMPAIGNS / f"{name}.json"


def value(address: str) -> Any:
    """Return what stands at an address: a number, a text or a list of lines.

    Raises
    ------
    InputError
        If the file cannot be read, or has nothing, or several numbers, at that place.
    """
    file, (_, where, *rest) = source(address), _parts(address)
    try:
        if file.suffix == ".csv":
            return _cell(file, where, rest[0], rest[1] if rest[1:] else "")
        found = json.loads(file.read_text(encoding="utf-8"))
        found = found if file.is_relative_to(provenance.RESULTS) else found["values"]
        for key in where.split("."):
            found = found[int(key)] if isinstance(found, list) else found[key]
        return found
    except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
        raise InputError(
            f"nothing to quote as {address!r} ({error!r})",
            file=file,
            remedy="Correct the address, or make the file",
        ) from error


def printed(address: str, found: Any) -> str:
    """Return a value as the address wants it printed."""
    if isinstance(found, list):
        return "\n" + "\n".join(found) + "\n"
    how = _parts(address)[-1].split()
    for word in how:
        if re.fullmatch(r"x[\d.e+-]+", word):
            found = float(found) * float(word[1:])
    style = [word for word in how if word.startswith(".") or word.endswith(("d", "f", "g"))]
    return format(found, style[0]) if style else str(found)


def _parts(address: str) -> list[str]:
    return [part.strip() for part in address.split(";")]


def _cell(file: Path, column: str, conditions: str, how: str) -> Any:
    with file.open(encoding="utf-8", newline="") as opened:
        rows = list(csv.DictReader(opened))
    wanted = [one.partition("=") for one in conditions.split("&") if one.strip()]
    cells = [
        row[column]
        for row in rows
        if all(row[name.strip()] == equal.strip() for name, _, equal in wanted)
    ]
    words = how.split()
    if "count" in words:
        return len(cells)
    for word in words:
        if word in _REDUCED:
            return _REDUCED[word]([number for cell in cells if isfinite(number := float(cell))])
    if len(cells) != 1:
        raise ValueError(f"{len(cells)} rows")
    try:
        return float(cells[0])
    except ValueError:
        return cells[0]
