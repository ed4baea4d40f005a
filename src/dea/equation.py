"""The equation of a model as readers want it: rounded, for HTML and LaTeX."""

import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from dea.number_format import number
from dea.terms import Term

DIGITS = 4
# The signals of the equation, each with the offset and scale that :class:`dea.narx.Scaling` names.
_SIGNALS = (("u", "input"), ("y", "output"))


def equation_text(terms: Sequence[Term], parameters: Iterable[float], digits: int = DIGITS) -> str:
    """Return ``y(t) = 0.9 y(t-1) - 0.1 u(t-1)^2`` with so many significant digits."""
    return "y(t) = " + _sum(parameters, [str(t) if t.degree else "" for t in terms], digits)


def equation_latex(terms: Sequence[Term], parameters: Iterable[float], digits: int = DIGITS) -> str:
    """Return the equation for LaTeX, without the dollars around it."""
    monomials = [term.mathematics().strip("$") if term.degree else "" for term in terms]
    return "y_{t} = " + _powers_of_ten(_sum(parameters, monomials, digits))


def equation_html(
    terms: Sequence[Term],
    parameters: Iterable[float],
    scaling: Mapping[str, float],
    units: tuple[str, str] = ("1", "1"),
    digits: int = DIGITS,
) -> str:
    """Return the equation and the scaling of its signals as HTML.

    Parameters
    ----------
    scaling
        ``u_offset``, ``u_scale``, ``y_offset`` and ``y_scale``.
    units
        Of input and output.
    """
    monomials = [term.html() if term.degree else "" for term in terms]
    equation = "<i>y</i>(<i>t</i>) = " + _sum(parameters, monomials, digits)
    scales = []
    for (signal, name), unit in zip(_SIGNALS, units, strict=True):
        offset, scale = scaling[f"{signal}_offset"], scaling[f"{signal}_scale"]
        if (offset, scale) != (0.0, 1.0):
            there = f" {escape(unit)}" if unit != "1" else ""
            scales.append(
                f"<i>{signal}</i> = ({name} {_signed(-offset, digits)}{there})"
                f" / {number(scale, digits)}{there}"
            )
    return f"<p>{equation}</p>" + (f"<p>{', '.join(scales)}</p>" if scales else "")


def _sum(parameters: Iterable[float], monomials: Sequence[str], digits: int) -> str:
    text = ""
    for parameter, monomial in zip(parameters, monomials, strict=True):
        space = " " if monomial else ""
        if text:
            text += f" {_signed(parameter, digits)}{space}{monomial}"
        else:
            text = f"{number(parameter, digits)}{space}{monomial}"
    return text


def _signed(value: float, digits: int) -> str:
    return f"{'-' if value < 0 else '+'} {number(abs(value), digits)}"


def _powers_of_ten(text: str) -> str:
    return re.sub(
        r"(\d)e([-+])0*(\d+)", lambda m: rf"{m[1]}\times 10^{{{m[2].strip('+')}{m[3]}}}", text
    )
