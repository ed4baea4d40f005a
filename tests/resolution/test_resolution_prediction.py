"""The predictive density of a record, where the search for its peak is not easy."""

from dataclasses import replace
from decimal import Decimal, localcontext
from types import SimpleNamespace

import numpy as np
import pytest
from made_devices import INTERVAL, NOISE, hidden
from scipy.optimize import minimize

from dea.discrepancy import Problem, Samples
from dea.discrepancy.fitting.fit import fit
from dea.resolution.error import Error
from dea.resolution.explanation import Explanation, explanation_of
from dea.resolution.prediction import predicted
from dea.simulation import prepared
from made_carriage import CARRIAGE

ERROR = Error(NOISE, 6e-3, 25.0)


def without_effects():
    """Return the simulation alone, and a record of a device that lags behind it."""
    u = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 12), 25)
    extended = prepared(CARRIAGE, u, INTERVAL, 1e-5)
    size = extended.layout.free.size
    deviation = np.where(extended.layout.own_of_records, 1.0, 0.02)
    explanation = Explanation(extended, np.zeros(size), np.diag(deviation))
    y = hidden("sensor_lag", [0.06, 0.9, 0.0])(u, 1)["output"].values
    return explanation, Samples(u, y, INTERVAL)


def test_the_peak_is_the_one_that_a_search_without_derivatives_finds():
    explanation, record = without_effects()
    deviation = explanation.deviations

    def cost(step):
        values = explanation.extended.layout.values(explanation.mean + deviation * step)
        left = record.y - explanation.extended.simulate(values, record.u, INTERVAL)
        whitened = ERROR.whitened(left)
        return whitened @ whitened + step @ step

    best = np.zeros(deviation.size)
    for _ in range(6):
        best = minimize(cost, best, method="Powell", options={"xtol": 1e-8, "ftol": 1e-12}).x
    found = predicted(explanation, record, ERROR).informed.mean / deviation
    shared = ~explanation.extended.layout.own_of_records
    np.testing.assert_allclose(found[shared], best[shared], atol=0.02)


def test_a_mean_that_runs_away_is_not_the_whole_belief(monkeypatch):
    explanation, record = without_effects()
    plain = Problem.residual

    def runs_away(problem, extended, values, *known):
        left = plain(problem, extended, values, *known)
        beyond = np.abs(extended.layout.coordinates(values)).max() > 1.0
        return np.full_like(left, np.nan) if beyond else left

    monkeypatch.setattr(Problem, "residual", runs_away)
    beyond = np.where(explanation.extended.layout.own_of_records, 0.0, 1.02)
    assert np.isfinite(predicted(replace(explanation, mean=beyond), record, ERROR).log_density)
    monkeypatch.setattr(Problem, "residual", lambda *arguments: np.full(record.u.size, np.nan))
    assert predicted(explanation, record, ERROR).log_density == -np.inf


@pytest.mark.parametrize("coloured", [0.0, 2.0])
def test_the_belief_is_as_sure_as_fits_to_a_part_of_a_record_are(coloured):
    """Estimates that take the noise for white, and see half of the samples, on 40 records."""
    rng = np.random.default_rng(8)
    u = np.repeat(rng.uniform(-1.0, 1.0, 40), 25)
    extended = prepared(CARRIAGE, u, INTERVAL, 1e-5)
    truth = np.zeros(extended.layout.free.size)
    simulated = extended.simulate(extended.layout.values(truth), u, INTERVAL)
    error = Error(NOISE, coloured * NOISE, 40.0, 4.0)
    lags = np.abs(np.subtract.outer(np.arange(u.size), np.arange(u.size)))
    poles = (error.memories - 1.0) / (error.memories + 1.0)
    S = error.white**2 * np.eye(u.size)
    S += error.coloured**2 * np.mean([pole**lags for pole in poles], axis=0)
    root = np.linalg.cholesky(S)
    seen = (np.arange(u.size) // 125) % 2 == 0
    none = np.zeros(u.size, bool)
    shared = ~extended.layout.own_of_records
    distances = []
    for _ in range(40):
        y = simulated + root @ rng.standard_normal(u.size)
        problem = Problem(u, y, INTERVAL, seen, none, none, noise=NOISE)
        found = explanation_of(fit(problem, extended, truth), problem, error)
        off = (found.mean - truth)[shared]
        within = (found.root @ found.root.T)[np.ix_(shared, shared)]
        distances.append(off @ np.linalg.solve(within, off) / off.size)
    assert np.mean(distances) == pytest.approx(1.0, abs=0.3)


@pytest.mark.parametrize("relative", [1e-2, 1e-6, 1e-10])
def test_the_root_of_a_quiet_sensor_is_that_of_its_covariance(relative):
    """The condition of the normal equations is up to 1e13; decimals tell the covariance."""
    rng = np.random.default_rng(1)
    k, n = 6, 300
    slopes = rng.standard_normal((n, k)) * np.logspace(0.0, -4.0, k) / relative
    slopes[:, 1] = slopes[:, 0] + 1e-4 * slopes[:, 1]
    extended = prepared(CARRIAGE, np.ones(n), INTERVAL, 1e-5)
    names = [f"parameter_{i}" for i in range(k)]
    simulation = SimpleNamespace(
        alone=SimpleNamespace(
            layout=SimpleNamespace(
                free=np.arange(k), names=names, bounds=(np.full(k, -9.0), np.full(k, 9.0))
            ),
            as_recorded=extended,
        ),
        layout=SimpleNamespace(own_of_records=np.zeros(k, bool), names=names, free=np.arange(k)),
    )
    found = SimpleNamespace(
        extended=simulation, jacobian=slopes, coordinates=np.zeros(k), records=[slice(0, n)]
    )
    problem = SimpleNamespace(seen=np.ones(n, bool), noise=1.0)
    error = Error(1.0, 0.5, 25.0)
    belief = explanation_of(found, problem, error)
    with localcontext() as context:
        context.prec = 60
        exact = decimal_sandwich(slopes, error.spread(slopes))
    np.testing.assert_allclose(belief.deviations, np.sqrt(np.diag(exact)), rtol=1e-6)
    whitened = np.linalg.solve(belief.root, np.linalg.solve(belief.root, exact).T)
    np.testing.assert_allclose(whitened, np.eye(k), atol=1e-5)


def decimal_sandwich(slopes, spread):
    """Return A⁻¹ (SᵀS + I) A⁻¹ with A = JᵀJ + I, by elimination in decimals."""
    exact = [
        np.array([[Decimal(float(x)) for x in row] for row in each]) for each in (slopes, spread)
    ]
    k = slopes.shape[1]
    one = np.array([[Decimal(int(i == j)) for j in range(k)] for i in range(k)])
    J, S = exact
    inverse = eliminated(J.T @ J + one, one)
    return (inverse @ (S.T @ S + one) @ inverse.T).astype(float)


def eliminated(A, B):
    """Return the solution of A X = B by Gauss and Jordan; A is positive definite."""
    A, B = A.copy(), B.copy()
    for i in range(len(A)):
        B[i], A[i] = B[i] / A[i, i], A[i] / A[i, i]
        for j in range(len(A)):
            if j != i:
                B[j], A[j] = B[j] - A[j, i] * B[i], A[j] - A[j, i] * A[i]
    return B
