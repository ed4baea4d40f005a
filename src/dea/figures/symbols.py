"""How residual tests and numbers are written, in figures (mathtext) and tables (LaTeX) alike."""

import re
from math import isfinite, isinf

DASH = "–"

_SQUARE = re.compile(r"([a-z])2")


def residual_test_as_mathematics(test: str) -> str:
    """Return a residual test such as ``phi_u2e`` as ``$\\phi_{u^2 e}$``."""
    letters = test.removeprefix("phi_").removeprefix("φ_").replace("²", "2").replace("^", "")
    subscript = _SQUARE.sub(r"\1^2", letters)
    return rf"$\phi_{{{subscript}}}$"


def number(value: float, digits: int = 3) -> str:
    """Return ``value`` with so many significant digits; infinity is a simulation that diverged."""
    if isinf(value):
        return "diverged"
    return f"{value:#.{digits}g}".rstrip(".") if isfinite(value) else DASH
