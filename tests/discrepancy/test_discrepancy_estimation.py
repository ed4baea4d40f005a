"""The parameters of an answer that leaves more than noise."""

import numpy as np
import pytest
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose
from dea.discrepancy.fitting.estimation import at_its_error, with_its_error
from dea.discrepancy.fitting.fit import cost_of, fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.simulation import catalogue, measured_scales, prepared
from dea.store import Record
from made_carriage import CARRIAGE

INTERVAL, NOISE, CLEAN = 0.02, 0.003, 1.15
INPUT = np.repeat(np.random.default_rng(1).uniform(-1, 1, 80), 25)


def explained(error):
    """Return a record of a bent reading with an ``error`` that moves with it, and a law's fit."""
    extended = prepared(CARRIAGE, INPUT, INTERVAL, tolerance=1e-4)
    still = extended.layout.prior_means
    y = extended.simulate(still, INPUT, INTERVAL)
    scale = float(np.std(y))
    y = y + 0.2 * (y - y.mean()) ** 2 / scale + error * scale * np.sin(9.0 * y / scale)
    y += NOISE * scale * np.random.default_rng(2).standard_normal(y.size)
    parts = split(INPUT, INTERVAL, 0.1)
    masks = parts.fit, parts.select, parts.certify
    problem = Problem(INPUT, y, INTERVAL, *masks, NOISE * scale, 1e-4, extended.substeps)
    scales = measured_scales(extended, still, problem)
    law = extended.attach(catalogue()["sensor_nonlinearity"], scales)
    start = law.layout.coordinates(
        np.r_[still, catalogue()["sensor_nonlinearity"].starts(scales)[0]]
    )
    return problem, fit(problem, law, start, iterations=60, tolerance=1e-8)


def test_an_answer_that_leaves_noise_stays_as_it_is():
    problem, fitted = explained(error=0.0)
    assert problem.seen_rmse(fitted.residual) < CLEAN * problem.noise
    assert with_its_error(problem, fitted, CLEAN) is problem
    assert at_its_error(problem, fitted, CLEAN) is fitted


def test_the_laws_of_one_that_leaves_more_return_towards_their_priors():
    problem, fitted = explained(error=0.2)
    left = problem.seen_rmse(fitted.residual)
    assert left > 5.0 * problem.noise
    within = with_its_error(problem, fitted, CLEAN)
    assert within.noise == pytest.approx(left)
    again = at_its_error(problem, fitted, CLEAN)
    laws = fitted.extended.layout.of_laws
    assert np.linalg.norm(again.coordinates[laws]) < 0.8 * np.linalg.norm(fitted.coordinates[laws])
    assert again.cost < cost_of(fitted.residual, fitted.coordinates, within)
    # What they give up is within the error that remains anyway.
    assert problem.seen_rmse(again.residual) < 1.1 * left


def test_the_estimate_does_not_depend_on_the_threads():
    problem, fitted = explained(error=0.2)
    alone, together = (at_its_error(problem, fitted, CLEAN, workers) for workers in (1, 2))
    assert np.array_equal(alone.coordinates, together.coordinates)
    assert alone.cost == together.cost


def test_an_answer_that_is_estimated_again_has_no_event_that_it_could_date():
    problem, _ = explained(error=0.04)
    record = Record.of(problem.u, problem.y, 1.0 / INTERVAL, units=("V", "V"))
    settings = Settings(effects=("sensor_nonlinearity",), budget=SEARCH)
    found = diagnose(record, CARRIAGE, settings=settings)
    assert found.decision.answer is not None
    assert found.extended is not found.decision.answer.fit
    assert "When it happened" not in found.verdict.sentence
    assert not found.certificate.dated
