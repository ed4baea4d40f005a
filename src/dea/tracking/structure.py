"""The structure that is tracked: the model's own, and a constant."""

from dataclasses import replace

import numpy as np

from dea.narx import NarxModel
from dea.terms import Term


def with_constant(model: NarxModel) -> NarxModel:
    """Return ``model`` with a constant, of zero, where it has none.

    In a drifting system the level changes first. Without a constant to represent it, the drift is
    attributed to the dynamic terms, and the tracked gain follows the level instead of the gain.
    """
    if Term() in model.terms:
        return model
    covariance = None
    if model.covariance is not None:
        covariance = np.zeros((len(model.terms) + 1, len(model.terms) + 1))
        covariance[1:, 1:] = model.covariance
    return replace(
        model,
        terms=(Term(), *model.terms),
        parameters=np.concatenate([[0.0], model.parameters]),
        covariance=covariance,
    )
