"""How numbers are written for readers, in figures and tables alike."""

from math import isfinite, isinf

DASH = "–"


def number(value: float, digits: int = 3) -> str:
    """Return ``value`` with so many significant digits; infinity is a simulation that diverged."""
    if isinf(value):
        return "diverged"
    return f"{value:#.{digits}g}".rstrip(".") if isfinite(value) else DASH
