"""How numbers are written for readers, in figures and tables alike."""

import re
from math import isfinite, isinf

DASH = "–"


def number(value: float, digits: int = 3) -> str:
    """Return ``value`` with so many significant digits; infinity is a simulation that diverged."""
    if isinf(value):
        return "diverged"
    return f"{value:#.{digits}g}".rstrip(".") if isfinite(value) else DASH


def written_out(text: str) -> str:
    """Return a text in which ``1.06e+03`` is 1060, as are all powers of ten up to the fifth."""
    return re.sub(r"\d(\.\d+)?e\+0[1-5]", lambda found: f"{float(found[0]):.0f}", text)


def share(value: float, low: float | None = None, high: float | None = None) -> str:
    """Return a share of one and its interval in per cent, as ``72 % (63 to 79 %)``."""
    if (value if low is None else low) >= 0.995:
        return "over 99 %"
    interval = "" if low is None or high is None else f" ({100 * low:.0f} to {100 * high:.0f} %)"
    return f"{100 * value:.0f} %{interval}"
