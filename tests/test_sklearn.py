import importlib
import sys

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
from sklearn.utils import estimator_checks

import dea
from dea.errors import InputError
from dea.sklearn import NarxRegressor

# The checks that do not give several features, and rows in no order of time, to the estimator.
SENSIBLE = [
    "check_estimator_cloneable",
    "check_estimator_repr",
    "check_get_params_invariance",
    "check_no_attributes_set_in_init",
    "check_parameters_default_constructible",
    "check_set_params",
    "check_estimators_unfitted",
    "check_estimator_tags_renamed",
    "check_valid_tag_types",
    "check_requires_y_none",
]


def record(size=300, seed=0):
    u = np.random.default_rng(seed).uniform(-1.0, 1.0, size)
    y = np.zeros(size)
    for t in range(2, size):
        y[t] = 0.6 * y[t - 1] + 0.5 * u[t - 2] + 0.2 * u[t - 2] ** 2
    return u[:, None], y


@pytest.mark.parametrize("name", SENSIBLE)
def test_the_checks_of_scikit_learn_pass(name):
    quick = NarxRegressor(y_lags=1, u_lags=1, degree=1, search="orthogonal")
    getattr(estimator_checks, name)("NarxRegressor", quick)


def test_it_is_the_selection_of_the_library():
    X, y = record()
    found = NarxRegressor(y_lags=1, u_lags=2, degree=2).fit(X, y)
    plain = dea.select_terms(X[:, 0], y, y_lags=1, u_lags=2, degree=2)
    assert found.model_.terms == plain.terms
    np.testing.assert_array_equal(found.predict(X), plain.simulate(X[:, 0]))
    assert found.score(*record(seed=1)) == pytest.approx(1.0, abs=1e-9)


def test_columns_are_inputs():
    u = np.random.default_rng(3).uniform(-1.0, 1.0, (300, 2))
    y = np.zeros(300)
    for t in range(1, 300):
        y[t] = 0.5 * y[t - 1] + 0.4 * u[t - 1, 0] - 0.3 * u[t - 1, 1]
    found = NarxRegressor(y_lags=1, u_lags=1, degree=1).fit(u, y)
    assert {str(term) for term in found.model_.terms} - {"1"} == {"y(t-1)", "u1(t-1)", "u2(t-1)"}
    np.testing.assert_array_equal(found.predict(u), found.model_.simulate(u))
    with pytest.raises(ValueError, match="1 features, but NarxRegressor is expecting 2"):
        found.predict(u[:, :1])


def test_a_grid_search_finds_the_lag_that_is_needed():
    grid = GridSearchCV(
        NarxRegressor(y_lags=1, degree=2, search="orthogonal"),
        {"u_lags": [1, 2]},
        cv=TimeSeriesSplit(2),
    )
    assert grid.fit(*record()).best_params_ == {"u_lags": 2}


def test_misuse_is_refused():
    X, y = record()
    with pytest.raises(NotFittedError):
        NarxRegressor().predict(X)
    with pytest.raises(InputError, match="none called 'quick'"):
        clone(NarxRegressor(search="quick")).fit(X, y)


def test_without_scikit_learn_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.base", None)
    monkeypatch.delitem(sys.modules, "dea.sklearn")
    with pytest.raises(ImportError, match="pip install scikit-learn"):
        importlib.import_module("dea.sklearn")
