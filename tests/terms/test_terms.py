import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.errors import InputError
from dea.terms import Term, is_term, numbered_inputs, static_value

terms = st.builds(
    Term.of,
    st.lists(st.integers(1, 12), max_size=4),
    st.lists(st.integers(0, 12), max_size=4),
)
_driven = st.lists(st.tuples(st.integers(0, 12), st.integers(1, 12)), min_size=1, max_size=4)
terms_of_several_inputs = st.builds(
    lambda outputs, driven: Term.of(outputs, *zip(*driven, strict=True)),
    st.lists(st.integers(1, 12), max_size=4),
    _driven,
)


@given(terms | terms_of_several_inputs)
def test_a_printed_term_reads_back(term):
    assert Term.parse(str(term)) == term


def test_a_delayed_output_is_one_output_alone():
    alone = {text: Term.parse(text).is_delayed_output for text in (
        "y(t-3)", "y(t-1)^2", "y(t-1)y(t-2)", "y(t-1)u(t)", "u(t-1)", "1",
    )}  # fmt: skip
    assert [text for text, found in alone.items() if found] == ["y(t-3)"]


@given(terms)
def test_a_term_as_mathematics_holds_every_factor(term):
    found = re.findall(r"([yu])_\{t(?:-(\d+))?\}(?:\^\{(\d+)\})?", term.mathematics())
    lags = {
        signal: sorted(
            int(lag or 0)
            for name, lag, power in found
            if name == signal
            for _ in range(int(power or 1))
        )
        for signal in "yu"
    }
    assert Term.of(lags["y"], lags["u"]) == term


@given(st.lists(terms, unique=True))
def test_terms_are_ordered_by_degree_and_outputs(unordered):
    ordered = sorted(unordered, key=lambda term: term.reading_order)
    keys = [(term.degree, -len(set(term.y_lags))) for term in ordered]
    assert keys == sorted(keys)


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("1", Term((), ())),
        ("y(t-1)", Term((1,), ())),
        ("u(t)", Term((), (0,))),
        ("u(t-0)", Term((), (0,))),
        ("y(t-1)u(t)", Term((1,), (0,))),
        ("y(t-1)^2u(t)^3", Term((1, 1), (0, 0, 0))),
        ("y(t-1)u(t-3)^2", Term((1,), (3, 3))),
        ("u(t-3) * y(t-1) * u(t-3)", Term((1,), (3, 3))),
        ("y(t-2)y(t-1)", Term((1, 2), ())),
        ("u1(t-1)", Term((), (1,), (1,))),
        ("u2(t)u1(t-3)", Term((), (3, 0), (1, 2))),
        ("u12(t-3)u2(t-4)u2(t-3)y(t-1)", Term((1,), (3, 4, 3), (2, 2, 12))),
    ],
)
def test_terms_are_written_as_people_write_them(text, term):
    assert Term.parse(text) == term


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x(t-1)",
        "y(t-1)u(t-3)^",
        "y[t-1]",
        "2",
        "y(t+1)",
        "y(t)",
        "u(t-1)1",
        "1 1",
        "u0(t-1)",
        "y1(t-1)",
        "u1(t-1)u(t-2)",
        "u(t-1)u2(t-2)",
    ],
)
def test_a_misspelt_term_is_refused(text):
    with pytest.raises(InputError, match="term"):
        Term.parse(text)
    assert not is_term(text)


@pytest.mark.parametrize(
    ("text", "mathematics"),
    [
        ("1", "$1$"),
        ("u(t-12)", "$u_{t-12}$"),
        ("u(t)", "$u_{t}$"),
        ("y(t-1)u(t)", "$y_{t-1}u_{t}$"),
        ("y(t-1)u(t)^2", "$y_{t-1}u_{t}^{2}$"),
        ("y(t-1)u(t-3)^2", "$y_{t-1}u_{t-3}^{2}$"),
        ("y(t-1)u2(t-3)^2u1(t)", "$y_{t-1}u_{1,t}u_{2,t-3}^{2}$"),
    ],
)
def test_a_term_as_mathematics(text, mathematics):
    assert Term.parse(text).mathematics() == mathematics


def test_tables_read_from_the_constant_to_the_products():
    ordered = [
        "1",
        "y(t-1)",
        "u(t)",
        "u(t-2)",
        "u(t-10)",
        "y(t-1)y(t-2)",
        "y(t-1)^2",
        "y(t-1)u(t)",
        "y(t-1)u(t-1)",
        "u(t)^2",
        "u(t)u(t-1)",
        "y(t-1)u(t)^2",
    ]
    found = sorted(map(Term.parse, reversed(ordered)), key=lambda term: term.reading_order)
    assert [str(term) for term in found] == ordered


@pytest.mark.parametrize(
    ("text", "degree", "lag"), [("1", 0, 0), ("u(t)", 1, 0), ("y(t-1)u(t)^2", 3, 1)]
)
def test_factors_without_a_lag_count(text, degree, lag):
    assert (Term.parse(text).degree, Term.parse(text).max_lag) == (degree, lag)


def test_terms_say_how_many_inputs_they_name():
    assert numbered_inputs([Term(), Term.parse("y(t-1)")]) is None
    assert numbered_inputs([Term(), Term.parse("u(t-1)")]) == 0
    assert numbered_inputs([Term.parse("u1(t-1)"), Term.parse("y(t-1)u3(t)")]) == 3
    with pytest.raises(InputError, match=r"u\(t-1\) does not say which input, u2\(t\) does"):
        numbered_inputs([Term.parse("u(t-1)"), Term.parse("u2(t)")])


@pytest.mark.parametrize(("lags", "inputs"), [((1, 2), (1,)), ((1,), (0,)), ((), (1,))])
def test_every_input_lag_needs_a_number(lags, inputs):
    with pytest.raises(InputError, match="Number the inputs from 1"):
        Term.of((), lags, inputs)


def test_the_value_of_constant_inputs_is_a_number_or_an_array_like_their_levels():
    powers = Term.parse("y(t-1)u1(t-1)u1(t-3)u3(t-1)").input_powers
    assert static_value(powers, [3.0, 5.0, 2.0]) == 18.0
    levels = np.array([[3.0, -1.0], [5.0, 5.0], [2.0, 4.0]])
    np.testing.assert_array_equal(static_value(powers, levels), [18.0, 4.0])
    assert static_value(Term.parse("y(t-2)").input_powers, [3.0]) == 1.0
