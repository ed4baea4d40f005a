"""Numbers and names as they are written on figures."""

import re
from collections.abc import Sequence
from itertools import count
from textwrap import wrap

from dea.effect_label import joined, name_and_place, parted, place_in_words

_PER_MM = 0.65  # letters, at the size of a title
# Letters of a line of a label beside an axis: longer ones leave the laws too little room.
_LABEL = 21
_PART = re.compile(r"[^_\-\s]+[_\-\s]*|[_\-\s]+")


def told_apart(values: Sequence[float]) -> list[str]:
    """Return numbers as text, with two digits or as many more as make those differ that do."""
    values = [value + 0.0 for value in values]  # minus zero is zero
    written = ([f"{value:.{digits}g}" for value in values] for digits in count(2))
    texts = next(each for each in written if len(set(each)) == len(set(values)))
    return [text.replace("-", "\N{MINUS SIGN}") for text in texts]


def in_lines(name: str, width: float) -> str:
    """Return a name in lines of at most ``width`` mm, broken behind its ``_``, ``-`` and spaces.

    In a name that does not fit on one, what follows a comma, as the input of a system with several,
    has lines of its own. A part that does not fit ends with an ellipsis.
    """
    most = max(int(_PER_MM * width), 2)
    if len(name) <= most:
        return name
    return "\n".join(line for each in re.split(", |\n", name) for line in _broken(each, most))


def _broken(name: str, most: int) -> list[str]:
    lines = [""]
    for part in _PART.findall(name):
        if len(lines[-1] + part.rstrip()) > most and lines[-1]:
            lines.append("")
        lines[-1] += part
    texts = [line.rstrip() for line in lines]
    return [text if len(text) <= most else f"{text[: most - 1]}…" for text in texts]


def in_words(label: str) -> str:
    """Return an effect's name in words and, below, the force port of the label, in short lines."""
    lines = joined(map(_placed, parted(label))).splitlines()
    return "\n".join(short for line in lines for short in wrap(line, _LABEL))


def _placed(label: str) -> str:
    name, place = name_and_place(label)
    return "\n".join(filter(None, (name.replace("_", " "), place_in_words(place))))
