"""The structure that is tracked: the model's own, and a constant."""

import numpy as np

from dea.narx import NarxModel
from dea.terms import Term


def with_constant(model: NarxModel) -> NarxModel:
    """Return ``model`` with a constant, of zero, where it has none.

    What changes first in a drifting system is its level. Without a constant to carry it the drift
    is charged to the dynamics, and gains follow the level instead of the gain.
    """
    if Term() in model.terms:
        return model
    return NarxModel(
        (Term(), *model.terms), np.concatenate([[0.0], model.parameters]), model.scaling
    )
