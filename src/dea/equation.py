"""The equation of a model as readers want it: rounded, for HTML and LaTeX."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape

from dea.number_format import number
from dea.terms import Term

DIGITS = 4


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
    scaling: Mapping[str, float | Sequence[float]],
    inputs: Sequence[tuple[str, str]] = (("input", "1"),),
    output_units: str = "1",
    digits: int = DIGITS,
) -> str:
    """Return the equation and the scaling of its signals as HTML.

    Parameters
    ----------
    scaling
        ``u_offset``, ``u_scale``, ``y_offset`` and ``y_scale``; of several inputs, the first two
        hold one number for each.
    inputs
        Name and units of each input; a single one is called the input.
    output_units
        Units of the output.
    """
    monomials = [term.html() if term.degree else "" for term in terms]
    equation = "<i>y</i>(<i>t</i>) = " + _sum(parameters, monomials, digits)
    scales = []
    for symbol, name, unit, offset, scale in _signals(scaling, inputs, output_units):
        if (offset, scale) != (0.0, 1.0) or (len(inputs) > 1 and symbol != "<i>y</i>"):
            there = f" {escape(unit)}" if unit != "1" else ""
            scales.append(
                f"{symbol} = ({escape(name)} {_signed(-offset, digits)}{there})"
                f" / {number(scale, digits)}{there}"
            )
    return f"<p>{equation}</p>" + (f"<p>{', '.join(scales)}</p>" if scales else "")


def _signals(
    scaling: Mapping[str, float | Sequence[float]],
    inputs: Sequence[tuple[str, str]],
    output_units: str,
) -> Iterator[tuple[str, str, str, float, float]]:
    """Symbol, name, units, offset and scale of every input and of the output."""
    offsets, scales = (_each(scaling[f"u_{what}"], len(inputs)) for what in ("offset", "scale"))
    for k, ((name, unit), offset, scale) in enumerate(zip(inputs, offsets, scales, strict=True)):
        several = len(inputs) > 1
        symbol = f"<i>u</i><sub>{k + 1}</sub>" if several else "<i>u</i>"
        yield symbol, name if several else "input", unit, offset, scale
    (offset,), (scale,) = (_each(scaling[f"y_{what}"], 1) for what in ("offset", "scale"))
    yield "<i>y</i>", "output", output_units, offset, scale


def _each(values: float | Sequence[float], count: int) -> Sequence[float]:
    return values if isinstance(values, Sequence) else (values,) * count


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
