"""Polynomial NARX models: terms, simulation, estimation, selection, validation."""

from dea.narx.model import NarxModel, Scaling
from dea.narx.regressors import regressor_matrix
from dea.narx.simulation import simulate, simulate_varying
from dea.narx.terms import Term, candidate_terms, linear_terms, max_lag

__all__ = [
    "NarxModel",
    "Scaling",
    "Term",
    "candidate_terms",
    "linear_terms",
    "max_lag",
    "regressor_matrix",
    "simulate",
    "simulate_varying",
]
