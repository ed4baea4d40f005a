"""Random terms and models for property tests, and the slow simulation they are checked against."""

import math

import numpy as np
from hypothesis import strategies as st

from dea.narx import NarxModel
from dea.terms import Term

lags = st.lists(st.integers(1, 5), max_size=3)
terms = st.builds(Term.of, lags, st.lists(st.integers(0, 5), max_size=3))
coefficients = st.floats(-0.3, 0.3, allow_nan=False)


@st.composite
def models(draw):
    chosen = draw(st.lists(terms, min_size=1, max_size=6, unique=True))
    values = draw(st.lists(coefficients, min_size=len(chosen), max_size=len(chosen)))
    return NarxModel(tuple(chosen), np.array(values))


def slow_simulation(terms, theta, u, y_initial, start):
    """Equation (7) as it stands, one sample and one term at a time; theta is (samples, terms)."""
    y = list(y_initial[:start])
    for t in range(start, len(u)):
        y.append(
            sum(
                theta[t][j]
                * math.prod(y[t - lag] for lag in term.y_lags)
                * math.prod(u[t - lag] for lag in term.u_lags)
                for j, term in enumerate(terms)
            )
        )
    return np.array(y)
