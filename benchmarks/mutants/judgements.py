"""Survivors that a person has judged to be no fault, and why.

Such a change alters no result, or one that was chosen freely, as how long a search goes on.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

FILE = Path(__file__).with_suffix(".yaml")

Change = tuple[str, str, str]  # file, the lines before, the lines after; without their indent


def change(row: Mapping[str, Any]) -> Change:
    """Return what a mutant changes; where in the file the lines are does not matter."""

    def lines(sign: str) -> str:
        found = (line[1:].strip() for line in row["diff"] if line.startswith(sign))
        return " ".join(" ".join(line.split()) for line in found)

    return row["file"], lines("-"), lines("+")


def judgements(file: Path = FILE) -> dict[Change, str]:
    """Return why a change is no fault, of each change that was judged so."""
    judged: Sequence[Mapping[str, str]] = yaml.safe_load(file.read_text()) or []
    return {(each["file"], each["before"], each["after"]): each["why"] for each in judged}
