import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from narx_strategies import models, slow_simulation

from dea.errors import InputError
from dea.narx import NarxModel, regressor_matrix, simulate, simulate_varying
from dea.terms import Term


@given(models(), st.integers(0, 2**32 - 1), st.integers(1, 60))
def test_free_run_equals_the_equation_term_by_term(model, seed, samples):
    rng = np.random.default_rng(seed)
    u, start = rng.uniform(-1, 1, samples), rng.uniform(-0.5, 0.5, 5)
    found = simulate(model.terms, model.parameters, u, start)
    theta = np.tile(model.parameters, (samples, 1))
    slow = slow_simulation(model.terms, theta, u, start, model.max_lag)[:samples]
    np.testing.assert_allclose(found, slow, rtol=1e-10, atol=1e-12)


@given(models(), st.integers(0, 2**32 - 1))
def test_varying_parameters_are_those_of_their_sample(model, seed):
    rng = np.random.default_rng(seed)
    u, start = rng.uniform(-1, 1, 40), rng.uniform(-0.5, 0.5, 5)
    theta = rng.uniform(-0.2, 0.2, (40, len(model.terms)))
    found = simulate_varying(model.terms, theta, u, start)
    slow = slow_simulation(model.terms, theta, u, start, model.max_lag)
    np.testing.assert_allclose(found, slow, rtol=1e-10, atol=1e-12)


def test_runs_longer_than_a_block_are_seamless():
    model = NarxModel.from_terms({"y(t-3)": 0.9, "u(t-2)": 1.0, "y(t-1)u(t-3)": 0.05})
    u = np.random.default_rng(1).uniform(-1, 1, 5000)
    theta = np.tile(model.parameters, (u.size, 1))
    slow = slow_simulation(model.terms, theta, u, np.zeros(3), 3)
    np.testing.assert_allclose(model.simulate(u, np.zeros(3)), slow, rtol=1e-9, atol=1e-11)
    varying = simulate_varying(model.terms, theta, u, np.zeros(3))
    np.testing.assert_allclose(varying, slow, rtol=1e-9, atol=1e-11)


def test_divergence_is_infinite_from_its_sample_on():
    terms = (Term.parse("y(t-1)^3"), Term.parse("u(t-1)"))
    theta = np.array([2.0, 1.0])
    y = simulate(terms, theta, np.ones(50), np.zeros(1))
    first = int(np.argmax(np.isinf(y)))
    assert 1 < first < 10
    assert np.all(np.isinf(y[first:]))
    assert np.all(np.abs(y[:first]) <= 1e10)
    varying = simulate_varying(terms, np.tile(theta, (50, 1)), np.ones(50), np.zeros(1))
    np.testing.assert_array_equal(varying, y)


def test_too_few_initial_outputs_are_refused():
    with pytest.raises(InputError, match="y_initial"):
        simulate((Term.parse("y(t-3)"),), np.ones(1), np.ones(9), np.zeros(2))
    with pytest.raises(InputError, match="theta"):
        simulate_varying((Term.parse("y(t-1)"),), np.ones((8, 1)), np.ones(9), np.zeros(2))


@given(models(), st.integers(0, 2**32 - 1))
def test_regressors_times_parameters_continue_a_free_run(model, seed):
    rng = np.random.default_rng(seed)
    u, start = rng.uniform(-1, 1, 30), rng.uniform(-0.5, 0.5, 5)
    y = simulate(model.terms, model.parameters, u, start)
    predicted = regressor_matrix(model.terms, u, y) @ model.parameters
    np.testing.assert_allclose(predicted, y[model.max_lag :], rtol=1e-10, atol=1e-12)


def test_a_model_without_a_parameter_for_each_term_is_refused():
    terms = tuple(map(Term.parse, ("y(t-1)", "u(t-1)", "u(t-2)")))
    with pytest.raises(InputError, match=r"parameters: its shape is \(1,\)\. Use \(3,\)"):
        simulate(terms, np.array([0.5]), np.ones(9), np.zeros(2))
