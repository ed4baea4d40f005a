import math

import numpy as np
import pytest

from dea.errors import InputError
from dea.narx import candidate_terms, linear_terms
from dea.terms import Term, max_lag


def test_lags_may_be_whole_numbers_of_numpy():
    expected = candidate_terms(2, [1, 3], 2)
    assert candidate_terms(np.int64(2), np.array([1, 3]), 2) == expected
    assert candidate_terms(2, np.int64(1), 2) == candidate_terms(2, 1, 2)


@pytest.mark.parametrize(("y_lags", "u_lags", "degree"), [(3, 3, 3), (1, 0, 2), (5, 2, 4)])
def test_candidates_are_every_monomial_once(y_lags, u_lags, degree):
    candidates = candidate_terms(y_lags, u_lags, degree)
    assert len(set(candidates)) == len(candidates) == math.comb(y_lags + u_lags + degree, degree)
    assert candidates[0] == Term()
    assert max(term.degree for term in candidates) == degree
    assert max_lag(candidates) == max(y_lags, u_lags)


def test_lags_may_start_after_a_dead_time():
    assert [str(term) for term in linear_terms(1, [4, 5])] == ["1", "y(t-1)", "u(t-4)", "u(t-5)"]


def test_more_candidates_than_can_be_chosen_from_are_refused_at_once():
    with pytest.raises(InputError, match="8 lagged signals to the degree 20 make 3108105 terms"):
        candidate_terms(4, 4, 20)


@pytest.mark.parametrize(
    "wrong",
    [{"y_lags": -1}, {"y_lags": [0, 1]}, {"y_lags": 2.5}, {"u_lags": None}, {"u_lags": [1.5]},
     {"degree": 0}, {"degree": 2.5}, {"degree": "2"}],
)  # fmt: skip
def test_impossible_candidates_are_refused(wrong):
    with pytest.raises(InputError):
        candidate_terms(**({"y_lags": 2, "u_lags": 2, "degree": 2} | wrong))
