import math

import pytest
from hypothesis import given
from narx_strategies import terms

from dea.errors import InputError
from dea.narx import Term, candidate_terms, linear_terms, max_lag


@given(terms)
def test_a_printed_term_reads_back(term):
    assert Term.parse(str(term)) == term


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("1", Term((), ())),
        ("y(t-1)", Term((1,), ())),
        ("u(t)", Term((), (0,))),
        ("y(t-1)u(t-3)^2", Term((1,), (3, 3))),
        ("u(t-3) * y(t-1) * u(t-3)", Term((1,), (3, 3))),
        ("y(t-2)y(t-1)", Term((1, 2), ())),
    ],
)
def test_terms_are_written_as_people_write_them(text, term):
    assert Term.parse(text) == term


@pytest.mark.parametrize(
    "text", ["", "x(t-1)", "y(t-1)u(t-3)^", "y[t-1]", "2", "y(t+1)", "y(t)", "u(t-1)1", "1 1"]
)
def test_a_misspelt_term_is_refused(text):
    with pytest.raises(InputError, match="term"):
        Term.parse(text)


@pytest.mark.parametrize(("y_lags", "u_lags", "degree"), [(3, 3, 3), (1, 0, 2), (5, 2, 4)])
def test_candidates_are_every_monomial_once(y_lags, u_lags, degree):
    candidates = candidate_terms(y_lags, u_lags, degree)
    assert len(set(candidates)) == len(candidates) == math.comb(y_lags + u_lags + degree, degree)
    assert candidates[0] == Term()
    assert max(term.degree for term in candidates) == degree
    assert max_lag(candidates) == max(y_lags, u_lags)


def test_lags_may_start_after_a_dead_time():
    assert [str(term) for term in linear_terms(1, [4, 5])] == ["1", "y(t-1)", "u(t-4)", "u(t-5)"]


@pytest.mark.parametrize("wrong", [{"y_lags": -1}, {"y_lags": [0, 1]}, {"degree": 0}])
def test_impossible_candidates_are_refused(wrong):
    with pytest.raises(InputError):
        candidate_terms(**({"y_lags": 2, "u_lags": 2, "degree": 2} | wrong))
