"""The held-out error is that of fitting to all parts but one, and ranks structures by it."""

import numpy as np
import pytest

import dea
from dea.errors import InputError
from dea.narx import Scaling, estimate, held_out_error, refine, rmse

TRUE = dea.NarxModel.from_terms({"y(t-1)": 0.7, "u(t-1)": 0.5, "u(t-1)^2": 0.2})


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(5)
    u = rng.uniform(-1.0, 1.0, 600)
    return u, TRUE.simulate(u) + 0.02 * rng.standard_normal(u.size)


def test_it_is_what_refining_on_the_other_parts_leaves(record):
    u, y = record
    model = refine(estimate(TRUE.terms, u, y, scaling=Scaling()), u, y)
    errors = []
    for first in (0, 200, 400):
        part = slice(first, first + 200)
        ends = [(a, b) for a, b in ((0, first), (first + 200, 600)) if b > a]
        fitted = refine(model, [u[a:b] for a, b in ends], [y[a:b] for a, b in ends])
        errors.append(rmse(y[part][1:], fitted.simulate(u[part], y[part])[1:]))
    expected = np.sqrt(np.mean(np.square(errors)))
    assert held_out_error(model, u, y, parts=3) == pytest.approx(expected, rel=1e-6)
    assert expected == pytest.approx(0.02, rel=0.1)


def test_a_structure_that_misses_a_term_has_the_larger_error(record):
    u, y = record
    whole = refine(estimate(TRUE.terms, u, y, scaling=Scaling()), u, y)
    poorer = refine(estimate(TRUE.terms[:2], u, y, scaling=Scaling()), u, y)
    assert held_out_error(poorer, u, y) > 2.0 * held_out_error(whole, u, y)


def test_a_model_that_diverges_has_an_infinite_error(record):
    unstable = dea.NarxModel.from_terms({"y(t-1)": 1.5, "u(t-1)": 0.5})
    assert held_out_error(unstable, *record) == np.inf


@pytest.mark.parametrize("parts", [1, 400])
def test_parts_too_few_or_too_short_are_refused(record, parts):
    with pytest.raises(InputError, match="parts"):
        held_out_error(TRUE, *record, parts=parts)
