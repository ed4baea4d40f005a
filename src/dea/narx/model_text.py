"""The equation of a model as text, every digit of its numbers included."""

from typing import TYPE_CHECKING

import numpy as np

from dea.equation import equation_text, scaled_signals, signed
from dea.narx.scaling import Scaling

if TYPE_CHECKING:
    from dea.narx.model import NarxModel


def model_text(model: "NarxModel") -> str:
    """Return the equation, and below it the scaling of its signals where they are scaled."""
    lines = [equation_text(model.terms, model.parameters.tolist(), digits=None)]
    if model.inputs > 1 or model.scaling != Scaling():
        scaling = {name: np.asarray(value).tolist() for name, value in vars(model.scaling).items()}
        signals = scaled_signals(scaling, model.named_inputs, model.labels.y_units)
        lines.append(
            ", ".join(
                f"{symbol} = ({name} {signed(-offset, digits=None)})/{scale!r}"
                for symbol, name, _, offset, scale in signals
            )
        )
    return "\n".join(lines)
