"""The equation of a model as text, every digit of its numbers included."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dea.arrays import Array
from dea.equation import scaled_signals
from dea.narx.scaling import Scaling
from dea.terms import Term

if TYPE_CHECKING:
    from dea.narx.model import NarxModel


def equation_text(model: "NarxModel") -> str:
    """Return the equation, and below it the scaling of its signals where they are scaled."""
    lines = [f"y(t) = {_sum(model.terms, model.parameters)}"]
    if model.inputs > 1 or model.scaling != Scaling():
        scaling = {name: np.asarray(value).tolist() for name, value in vars(model.scaling).items()}
        signals = scaled_signals(scaling, model.named_inputs, model.labels.y_units)
        lines.append(
            ", ".join(
                f"{symbol} = ({name} {_signed(-offset)})/{scale!r}"
                for symbol, name, _, offset, scale in signals
            )
        )
    return "\n".join(lines)


def _sum(terms: Sequence[Term], parameters: Array) -> str:
    text = ""
    for term, parameter in zip(terms, parameters.tolist(), strict=True):
        monomial = f" {term}" if term.degree else ""
        text += f" {_signed(parameter)}{monomial}" if text else f"{parameter!r}{monomial}"
    return text


def _signed(number: float) -> str:
    return f"{'-' if np.signbit(number) else '+'} {abs(number)!r}"
