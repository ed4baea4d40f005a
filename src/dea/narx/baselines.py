"""Simple structures that a NARX model has to beat."""

from collections.abc import Mapping

import numpy as np

from dea.narx.candidate_terms import linear_terms
from dea.narx.model import NarxModel
from dea.terms import Term


def baselines(model: NarxModel) -> Mapping[str, NarxModel]:
    """Return structures to compare ``model`` with, by name, their parameters all zero.

    ``cubic``: a static polynomial of third order in the input before, without memory; of several
    inputs, the sum of one in each.
    ``hammerstein``: the same followed by one pole. ``linear``: the lags of the model, without
    products.
    """
    lag, inputs = max(model.max_lag, 1), model.inputs
    _, *driving = linear_terms(0, 1, inputs)
    powers = [Term((), u.u_lags * p, u.inputs * p) for u in driving for p in (1, 2, 3)]
    structures = {
        "linear": linear_terms(lag, lag, inputs),
        "hammerstein": (Term(), Term.of((1,), ()), *powers),
        "cubic": (Term(), *powers),
    }
    return {
        name: NarxModel(terms, np.zeros(len(terms)), model.scaling)
        for name, terms in structures.items()
    }


def constant(model: NarxModel) -> NarxModel:
    """Return the structure that holds a constant alone, in the scaling of ``model``."""
    return NarxModel((Term(),), np.zeros(1), model.scaling)
