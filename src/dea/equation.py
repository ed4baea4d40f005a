"""The equation of a model as readers want it: rounded, for a terminal, HTML and LaTeX."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import NamedTuple

from dea.number_format import number
from dea.terms import Term, input_symbol

_DIGITS = 4  # significant ones of every number


def equation_text(
    terms: Sequence[Term], parameters: Iterable[float], digits: int | None = _DIGITS
) -> str:
    """Return ``y(t) = 0.9 y(t-1) - 0.1 u(t-1)^2``; without ``digits``, with all there are."""
    return "y(t) = " + _sum(parameters, [str(t) if t.degree else "" for t in terms], digits)


def equation_latex(terms: Sequence[Term], parameters: Iterable[float]) -> str:
    """Return the equation for LaTeX, without the dollars around it."""
    monomials = [term.mathematics().strip("$") if term.degree else "" for term in terms]
    return "y_{t} = " + _powers_of_ten(_sum(parameters, monomials))


def scaling_text(
    scaling: Mapping[str, float | Sequence[float]],
    inputs: Sequence[tuple[str, str]] = (("input", "1"),),
    output_units: str = "1",
) -> str:
    """Return ``u = (input - 2.500 V) / 1.200 V, y = (output + 1.000) / 2.000`` of scaled signals.

    It is empty where the equation holds for the input and the output themselves. The parameters
    are those of :func:`equation_html`.
    """
    return ", ".join(
        f"{signal.symbol} = {_of_signal(signal)}"
        for signal in scaled_signals(scaling, inputs, output_units)
        if signal.explained
    )


def equation_html(
    terms: Sequence[Term],
    parameters: Iterable[float],
    scaling: Mapping[str, float | Sequence[float]],
    inputs: Sequence[tuple[str, str]] = (("input", "1"),),
    output_units: str = "1",
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
    equation = "<i>y</i>(<i>t</i>) = " + _sum(parameters, monomials)
    scales = []
    for signal in scaled_signals(scaling, inputs, output_units):
        letter, column = signal.symbol[0], signal.symbol[1:]
        if signal.explained:
            subscript = f"<sub>{column}</sub>" if column else ""
            scales.append(f"<i>{letter}</i>{subscript} = {escape(_of_signal(signal))}")
    return f"<p>{equation}</p>" + (f"<p>{', '.join(scales)}</p>" if scales else "")


class ScaledSignal(NamedTuple):
    """A signal of an equation: ``symbol`` is ``name`` less ``offset``, over ``scale``."""

    symbol: str
    name: str
    units: str
    offset: float
    scale: float

    @property
    def explained(self) -> bool:
        """Whether a reader must be told: it is scaled, or one of several inputs."""
        return (self.offset, self.scale) != (0.0, 1.0) or len(self.symbol) > 1


def scaled_signals(
    scaling: Mapping[str, float | Sequence[float]],
    inputs: Sequence[tuple[str, str]],
    output_units: str,
) -> Iterator[ScaledSignal]:
    """Return every input and the output; the parameters are those of :func:`equation_html`."""
    count = len(inputs)
    offsets, scales = (_each(scaling[f"u_{what}"], count) for what in ("offset", "scale"))
    for k, ((name, unit), offset, scale) in enumerate(zip(inputs, offsets, scales, strict=True)):
        called = name if count > 1 else "input"
        yield ScaledSignal(input_symbol(k, count), called, unit, offset, scale)
    (offset,), (scale,) = (_each(scaling[f"y_{what}"], 1) for what in ("offset", "scale"))
    yield ScaledSignal("y", "output", output_units, offset, scale)


def _each(values: float | Sequence[float], count: int) -> Sequence[float]:
    return values if isinstance(values, Sequence) else (values,) * count


def _of_signal(signal: ScaledSignal) -> str:
    units = f" {signal.units}" if signal.units != "1" else ""
    offset, scale = signed(-signal.offset), number(signal.scale, _DIGITS)
    return f"({signal.name} {offset}{units}) / {scale}{units}"


def _sum(
    parameters: Iterable[float], monomials: Sequence[str], digits: int | None = _DIGITS
) -> str:
    text = ""
    for parameter, monomial in zip(parameters, monomials, strict=True):
        space = " " if monomial else ""
        if text:
            text += f" {signed(parameter, digits)}{space}{monomial}"
        else:
            text = f"{_written(parameter, digits)}{space}{monomial}"
    return text


def signed(value: float, digits: int | None = _DIGITS) -> str:
    """Return ``- 0.1`` or ``+ 0.1``, as it stands after another number."""
    return f"{'-' if value < 0 else '+'} {_written(abs(value), digits)}"


def _written(value: float, digits: int | None) -> str:
    return repr(value) if digits is None else number(value, digits)


def _powers_of_ten(text: str) -> str:
    return re.sub(
        r"(\d)e([-+])0*(\d+)", lambda m: rf"{m[1]}\times 10^{{{m[2].strip('+')}{m[3]}}}", text
    )
