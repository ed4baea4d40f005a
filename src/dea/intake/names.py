"""What the names of columns tell of them."""

import re
from collections.abc import Callable

# Whole names, a number behind them at most: as words of a longer one they are prepositions.
_ALONE = {"in", "out"}
ColumnUnits = tuple[str, str | None]  # its name and its units, where they are known


def named(words: set[str]) -> Callable[[str], bool]:
    """Return a function that tells whether a name is one of these words, or holds one."""

    def matches(name: str) -> bool:
        whole = name.lower()
        parts = re.split(r"[^a-z0-9]+", whole)
        alone = re.sub(r"[^a-z]*\d*$", "", whole) in words & _ALONE
        return whole in words or alone or bool((words - _ALONE).intersection(parts))

    return matches
