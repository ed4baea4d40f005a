"""Each method on records whose missing effect is known, and its parts against independent ones."""

from dataclasses import replace

import numpy as np
import pytest
from made_tasks import STIFFNESS, pose, recorded
from scipy.integrate import solve_ivp

from benchmarks.naming.methods import REFERENCE, _grey_box, methods
from benchmarks.naming.methods._library import CORRECTION, FOREIGN, Term, library
from benchmarks.naming.methods._stlsq import stlsq
from benchmarks.naming.methods.sindy import Discrepancy, Equation, run
from dea.simulation import catalogue

# Effects to choose from where it does not matter how many there are.
FEW = ("dead_zone", "sensor_lag", "strain_stiffening")


def cubic(x, v):
    return -0.02 * STIFFNESS * x**3


@pytest.fixture(scope="module")
def stiffened():
    return pose(recorded(cubic), effects=FEW)


@pytest.fixture(scope="module")
def plain():
    return pose(recorded(), effects=FEW)


@pytest.fixture
def few_in_grey_box(monkeypatch):
    few = {effect: catalogue()[effect] for effect in FEW}
    monkeypatch.setattr(_grey_box, "catalogue", lambda: few)


def answered(name, given):
    return methods()[name].answer(given.task)


def test_the_lorenz_equations_come_out_of_thresholded_least_squares():
    """Brunton, Proctor and Kutz 2016, Fig. 1: three equations with seven terms in all."""

    def lorenz(t, x):
        return [10 * (x[1] - x[0]), x[0] * (28 - x[2]) - x[1], x[0] * x[1] - 8 / 3 * x[2]]

    x = solve_ivp(lorenz, (0, 20), [-8, 7, 27], t_eval=np.arange(0, 20, 2e-3), rtol=1e-9).y
    rates = np.array(lorenz(0, x))
    rates = rates + 0.1 * np.random.default_rng(0).standard_normal(rates.shape)
    names = ["1", "x", "y", "z", "xx", "xy", "xz", "yy", "yz", "zz"]
    X = np.column_stack([np.ones(x.shape[1]), *x]
                        + [x[i] * x[j] for i in range(3) for j in range(i, 3)])  # fmt: skip
    expected = (
        {"x": -10, "y": 10}, {"x": 28, "y": -1, "xz": -1}, {"xy": 1, "z": -8 / 3},
    )  # fmt: skip
    for rate, terms in zip(rates, expected, strict=True):
        found = stlsq(X.T @ X, X.T @ rate, threshold=0.1, ridge=0.05)
        assert {names[k] for k in np.flatnonzero(found)} == set(terms)
        for name, value in terms.items():
            assert found[names.index(name)] == pytest.approx(value, abs=0.02)


def test_every_effect_of_the_catalogue_has_a_sign_in_the_library():
    rng = np.random.default_rng(1)
    terms = library(*rng.standard_normal((2, 1000)), rng.standard_normal(800), 0.02)
    readings = {"backlash"}
    assert {t.in_motion for t in terms} - {CORRECTION, FOREIGN} == set(catalogue()) - readings
    forces = {"strain_stiffening", "end_stop", "rate_independent_hysteresis"}
    assert {t.in_reading for t in terms} - {CORRECTION, FOREIGN} == set(catalogue()) - forces
    assert len({term.name for term in terms}) == len(terms)
    assert all(np.mean(term.values**2) == pytest.approx(1.0) for term in terms)


@pytest.mark.slow
@pytest.mark.parametrize("own", [[-2.0], [-9.0, -2.0]])
def test_the_free_run_of_an_equation_is_its_solution(own):
    t = np.arange(400) * 0.01
    order = len(own)
    start = np.eye(order)[0]

    def slopes(time, x):
        return [*x[1:], np.dot(own, x) + np.sin(3.0 * time)]

    expected = solve_ivp(slopes, (0, 4), start, t_eval=t, rtol=1e-9, atol=1e-12).y[0]
    found = run(np.array(own), np.sin(3.0 * t), start, 0, 0.01)
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_sindy_recovers_a_cubic_spring(stiffened):
    answer = answered("sindy", stiffened)
    assert (answer.status, answer.effects) == ("named", {"strain_stiffening"})
    assert stiffened.error(answer.ahead) < 0.7 * reference_error(stiffened)


def test_sindy_counts_terms_by_what_the_others_cannot_make_up_for():
    """Orthogonal columns: each contributes its coefficient, whatever lies beside it."""
    signs = [CORRECTION, "sensor_lag", FOREIGN, "end_stop", "dead_zone", "dead_zone"]
    terms = [Term(str(k), sign, FOREIGN, np.zeros(0)) for k, sign in enumerate(signs)]
    found = Discrepancy(None, terms, 0.02)

    def names(*coefficients, alike=0.0):
        """``alike`` correlates the last two terms, which then nearly cancel."""
        G = np.eye(len(signs) + 1)
        G[5, 6] = G[6, 5] = alike
        c = np.array([0.0, *coefficients])
        target = G @ c
        whole = np.zeros((len(c) + 1, len(c) + 1))
        whole[:-1, :-1], whole[:-1, -1], whole[-1, :-1] = G, target, target
        whole[-1, -1] = c @ target + 0.1
        return found.names(Equation(1, c[:1], c[1:], whole))

    assert names(9.0, 1.0, 0.0, 0.0, 0.0, 0.0) == {"sensor_lag"}
    assert names(0.0, 1.0, 0.0, 0.6, 0.0, 0.0) == {"sensor_lag", "end_stop"}
    assert names(0.0, 1.0, 0.0, 0.4, 0.0, 0.0) == {"sensor_lag"}
    assert names(0.0, 1.0, 0.6, 0.0, 0.0, 0.0) == {"sensor_lag"}
    assert names(0.0, 1.0, 2.0, 0.0, 0.0, 0.0) == frozenset()
    assert names(9.0, 0.0, 0.0, 0.0, 0.0, 0.0) == frozenset()
    assert names(0.0, 1.0, 0.0, 0.0, 9.0, -9.0) == {"dead_zone"}
    assert names(0.0, 1.0, 0.0, 0.0, 9.0, -9.0, alike=0.9999) == {"sensor_lag"}


def reference_error(given):
    return given.error(answered(REFERENCE, given).ahead)


def test_ridge_predicts_and_names_nothing(stiffened):
    answer = answered("ridge", stiffened)
    assert (answer.status, answer.effects) == ("unknown", frozenset())
    assert stiffened.error(answer.ahead) < 0.7 * reference_error(stiffened)


@pytest.mark.parametrize("name", ["ridge", "sindy", REFERENCE])
def test_nothing_is_said_where_nothing_is_missing(name, plain):
    answer = answered(name, plain)
    assert answer.status == "none"
    assert plain.error(answer.ahead) == pytest.approx(2e-3, rel=0.15)


@pytest.mark.parametrize("name", ["ridge", "sindy"])
def test_a_simulation_that_runs_away_ahead_predicts_nothing_but_is_learned_from(
    name, stiffened, monkeypatch
):
    before = answered(name, stiffened)
    simulated = type(stiffened.task).simulated

    def away(task, fitted):
        run = simulated(task, fitted)
        return np.where(np.arange(run.size) < 1800, run, np.nan)

    monkeypatch.setattr(type(stiffened.task), "simulated", away)
    after = answered(name, stiffened)
    assert after.status == before.status
    assert np.isfinite(after.ahead[:200]).all()
    assert stiffened.error(after.ahead) == np.inf


def test_akaikes_criterion_is_that_of_the_likelihood():
    residual = np.random.default_rng(2).standard_normal(500)
    variance = np.mean(residual**2)
    likelihood = -0.5 * np.sum(np.log(2 * np.pi * variance) + residual**2 / variance)
    constant = 500 * (1 + np.log(2 * np.pi))
    assert _grey_box.aic(residual, 3) == pytest.approx(2 * 4 - 2 * likelihood - constant)


def test_the_grey_box_picks_the_stiffening_spring(stiffened, few_in_grey_box):
    answer = answered("aic_single", stiffened)
    assert (answer.status, answer.effects) == ("named", {"strain_stiffening"})
    assert stiffened.error(answer.ahead) == pytest.approx(2e-3, rel=0.5)


def test_the_diagnosis_names_the_stiffening_spring(stiffened):
    answer = answered("diagnosis", stiffened)
    assert (answer.status, answer.effects) == ("named", {"strain_stiffening"})
    assert stiffened.error(answer.ahead) == pytest.approx(2e-3, rel=0.5)


def test_a_diagnosis_without_a_name_predicts_as_the_simulation_alone(plain):
    answer = answered("diagnosis", plain)
    assert answer.status == "none"
    np.testing.assert_array_equal(answer.ahead, answered(REFERENCE, plain).ahead)


def test_random_choice_follows_from_the_task_and_spreads(plain):
    first, again = (answered("random_choice", plain) for _ in range(2))
    assert (first.status, first.effects) == (again.status, again.effects)
    assert first.effects <= set(catalogue())
    choose = methods()["random_choice"].answer
    answers = [choose(replace(plain.task, name=str(k))) for k in range(60)]
    assert len({answer.effects for answer in answers}) > 12


def test_a_task_does_not_lead_to_what_is_kept_back():
    record = recorded(samples=500)
    task, kept = pose(record)
    np.testing.assert_array_equal(np.concatenate([task.y, kept]), record.y)
    assert task.y.base is None
    assert not np.shares_memory(task.y, record.y)


@pytest.fixture(scope="module")
def one_ahead_and_another():
    """Two tasks whose records differ in what is kept back alone."""
    record = recorded(cubic, samples=1000)
    other = record.y.copy()
    other[800:] = 100.0 * np.random.default_rng(3).standard_normal(200)
    return pose(record, effects=FEW), pose(record._replace(y=other), effects=FEW)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(methods()))
def test_no_answer_depends_on_what_is_kept_back(name, one_ahead_and_another, few_in_grey_box):
    found, again = (answered(name, each) for each in one_ahead_and_another)
    assert found.ahead.shape == (200,)
    assert (again.status, again.effects, again.rivals) == (
        found.status, found.effects, found.rivals
    )  # fmt: skip
    np.testing.assert_array_equal(again.ahead, found.ahead)
