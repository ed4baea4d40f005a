"""One message that asks for all settings a file leaves open, with the command that gives them."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from dea.errors import InputError
from dea.store import ForeignTable

KEPT = ", kept from the case"  # said of what an earlier case of the file answered


class UnansweredError(InputError):
    """Something that only the user knows; the message shows the columns and how to answer."""

    def __init__(self, asked: Sequence[str], command: str, file: Path, columns: str) -> None:
        super().__init__(f"it does not say {', nor '.join(asked)}", file=file)
        self.command, self.columns = command, columns

    def __str__(self) -> str:
        """Return the message of several lines."""
        return f"{super().__str__()}.\n\n{self.columns}\n\nAnswer with\n\n  {self.command}\n"


def described(table: ForeignTable) -> str:
    """Return one line for each column: its name, its units, its range, or what else it holds."""
    width = max(map(len, [*table.columns, *table.no_numbers, "column"]))
    wide = max(map(len, [*table.units.values(), "units"]))
    lines = [f"  {'column':{width}}  {'units':{wide}}  values"]
    for name, values in table.columns.items():
        there = values[np.isfinite(values)]
        span = f"{there.min():.5g} to {there.max():.5g}" if there.size else "none"
        missing = values.size - there.size
        note = f"{missing} of {values.size} missing" if missing else f"{values.size} of them"
        lines.append(f"  {name:{width}}  {table.units.get(name, '?'):{wide}}  {span}, {note}")
    lines += [f"  {name:{width}}  {'-':{wide}}  {told}" for name, told in table.no_numbers.items()]
    return "\n".join(lines)


def command(goal: str, answers: Mapping[str, str]) -> str:
    """Return the command line that gives these answers."""
    return " ".join(["make", goal, *(answer(key, value) for key, value in answers.items())])


def answer(key: str, value: str) -> str:
    """Return one answer as it stands on a command line of make, quoted where a shell needs it."""
    word = f"{key}={value.replace('$', '$$')}"
    quoted = shlex.quote(word)
    return quoted if quoted == word or set(word) & set('$`"\\!') else f'"{word}"'
