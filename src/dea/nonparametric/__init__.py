"""Frequency responses measured line by line from periodic excitation, without a model."""

from dea.nonparametric.agreement import (
    Agreement,
    RelativeBand,
    compare_intermodulation,
    compare_response,
)
from dea.nonparametric.best_linear import BestLinear, best_linear
from dea.nonparametric.confirmation import Modelled, confirmation
from dea.nonparametric.intermodulation import Intermodulation, intermodulation
from dea.nonparametric.periods import Periods, periods_of
from dea.nonparametric.probed_record import Estimates, best_linear_approximation, estimates

__all__ = [
    "Agreement",
    "BestLinear",
    "Estimates",
    "Intermodulation",
    "Modelled",
    "Periods",
    "RelativeBand",
    "best_linear",
    "best_linear_approximation",
    "compare_intermodulation",
    "compare_response",
    "confirmation",
    "estimates",
    "intermodulation",
    "periods_of",
]
