"""What the names of columns tell of them."""

import re
from collections.abc import Callable

# Whole names, a number behind them at most: as words of a longer one two are prepositions, and the
# third is that of something else (slew_rate).
_ALONE = {"in", "out", "rate"}
ColumnUnits = tuple[str, str | None]  # its name and its units, where they are known


def named(words: set[str]) -> Callable[[str], bool]:
    """Return a function that tells whether a name is one of these words, or holds one.

    Words that are joined by ``_`` may be separated by anything else in the name.
    """

    def matches(name: str) -> bool:
        whole = name.lower()
        parts = f"_{'_'.join(re.split(r'[^a-z0-9]+', whole))}_"
        alone = re.sub(r"[^a-z]*\d*$", "", whole) in words & _ALONE
        return whole in words or alone or any(f"_{word}_" in parts for word in words - _ALONE)

    return matches
