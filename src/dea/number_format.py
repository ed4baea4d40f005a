"""How numbers are written for readers, in figures and tables alike."""

import re
from math import isfinite, isinf

DASH = "–"
# Times that an interval may reach further on one side than on the other to be told by its half.
_LOPSIDED = 2.0


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


def quantity(value: float, unit: str) -> str:
    """Return a value with its unit, as ``1.5 Hz``; of a pure number, ``1``, there is none."""
    return f"{value:.3g}{_after(unit)}"


def _after(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def estimate(value: float, low: float, high: float, unit: str, *, at_bound: bool = False) -> str:
    """Return a parameter's value with half of its interval, and of one at its bound that it is.

    Where the interval reaches much further on one side, its ends alone are told.
    """
    if at_bound:
        return f"{quantity(value, unit)} at its bound"
    units = _after(unit)
    below, above = value - low, high - value
    if max(below, above) > _LOPSIDED * min(below, above):
        return f"{low:.3g} to {high:.3g}{units}"
    return f"{value:.3g} ± {0.5 * (high - low):.2g}{units}"
