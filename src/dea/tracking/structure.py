"""The structure that is tracked: the model's own, and a constant."""

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
    return NarxModel(
        (Term(), *model.terms),
        np.concatenate([[0.0], model.parameters]),
        model.scaling,
        covariance,
        withheld=model.withheld,
        labels=model.labels,
    )
