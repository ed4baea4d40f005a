"""An event that no seen sample dates."""

from dataclasses import replace

import numpy as np
import pytest

from dea.discrepancy.fitting.events import with_events_dated
from dea.discrepancy.fitting.fit import at, cost_of, fit
from dea.discrepancy.problem.problem import Problem, rmse
from dea.discrepancy.problem.split import split
from dea.simulation import catalogue, load_simulation, measured_scales, prepared

INTERVAL, NOISE, STEP, SIZE = 0.02, 0.002, 0.4, 3000
INPUT = np.repeat(np.random.default_rng(1).uniform(-2, 2, SIZE // 25), 25)
ENDS = INPUT.min(), INPUT.max()
PARTS = split(INPUT, INTERVAL, 0.1)


def stepped(place, started):
    """Return a problem in which the output is shifted at ``place`` (s), and a fit of that."""
    extended = prepared(load_simulation("mass_spring_damper"), INPUT, INTERVAL, 1e-4)
    y = extended.simulate(extended.layout.prior_means, INPUT, INTERVAL)
    y += STEP * (INTERVAL * np.arange(SIZE) >= place)
    y += NOISE * np.random.default_rng(2).standard_normal(SIZE)
    masks = PARTS.fit, PARTS.select, PARTS.certify
    problem = Problem(INPUT, y, INTERVAL, *masks, NOISE, 1e-4, extended.substeps)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    scales = replace(measured_scales(extended, nominal.values, problem), jumps=(started,))
    law = extended.attach(catalogue()["step_fault"], scales)
    start = law.attached[0].started(
        (started, 0.0, STEP, 4 * INTERVAL, 0.0, *ENDS[::-1], 0.0, *ENDS, 6.0, 1.2, 0.0)
    )
    values = law.layout.coordinates(np.concatenate([nominal.values, start]))
    return problem, fit(problem, law, values, iterations=40)


def certified(part):
    """Return the instant (s) at a ``part`` of the certified block."""
    first, last = np.flatnonzero(PARTS.certify)[[0, -1]]
    return INTERVAL * (first + part * (last - first))


@pytest.mark.parametrize(("truth", "guess"), [(0.2, 0.8), (0.55, 0.45)])
def test_an_event_in_the_certified_block_is_dated_there(truth, guess):
    problem, fitted = stepped(certified(truth), certified(guess))
    assert rmse(fitted.residual, problem.certify) > 20 * NOISE
    dated = with_events_dated(problem, fitted)
    names = dated.extended.layout.names
    instant = dated.values[names.index("step_fault.instant")]
    assert instant == pytest.approx(certified(truth), abs=3 * INTERVAL)
    assert rmse(dated.residual, problem.certify) < 1.5 * NOISE
    others = ~dated.extended.layout.events
    assert np.allclose(dated.coordinates[others], fitted.coordinates[others], atol=1e-12)


@pytest.mark.parametrize("samples", [2, 4])
def test_an_event_that_a_fit_left_a_few_samples_outside_is_dated_in_the_certified_block(samples):
    """A step of the gain just before the block hardly moves a mass in the samples that are left."""
    extended = prepared(load_simulation("mass_spring_damper"), INPUT, INTERVAL, 1e-4)
    law = catalogue()["step_fault"]
    first = np.flatnonzero(PARTS.certify)[0]
    last_seen = INTERVAL * np.flatnonzero((PARTS.fit | PARTS.select)[:first])[-1]

    def broken(scales, instant):
        made = extended.attach(law, scales)
        event = (instant, -0.3, 0.0, INTERVAL, 0.0, *ENDS[::-1], 0.0, *ENDS, 6.0, 1.2, 0.0)
        start = made.attached[0].started(event)
        own = extended.layout.prior_means
        return made, np.concatenate([own, start])

    masks = PARTS.fit, PARTS.select, PARTS.certify
    problem = Problem(INPUT, INPUT, INTERVAL, *masks, NOISE, 1e-4, extended.substeps)
    scales = measured_scales(extended, extended.layout.prior_means, problem)
    made, truth = broken(scales, certified(0.6))
    y = made.simulate(truth, INPUT, INTERVAL)
    y += NOISE * np.random.default_rng(2).standard_normal(SIZE)
    problem = replace(problem, y=y)
    made, left = broken(scales, last_seen - samples * INTERVAL)
    fitted = at(problem, made, made.layout.coordinates(left))
    assert rmse(fitted.residual, problem.certify) > 20 * NOISE
    dated = with_events_dated(problem, fitted)
    instant = dated.values[dated.extended.layout.names.index("step_fault.instant")]
    assert instant == pytest.approx(certified(0.6), abs=3 * INTERVAL)
    assert rmse(dated.residual, problem.certify) < 1.5 * NOISE


def test_an_event_that_seen_samples_date_stays():
    instant = INTERVAL * np.flatnonzero(PARTS.fit)[30]
    problem, fitted = stepped(instant, instant)
    assert with_events_dated(problem, fitted) is fitted


def test_of_certified_samples_that_hold_no_event_none_is_fitted():
    """An error there that is no event stays an error: sizes are those of the seen samples."""
    problem, fitted = stepped(certified(0.5), certified(0.5))
    wrong = replace(problem, y=problem.y + 0.5 * STEP * problem.certify)
    residual = fitted.residual + 0.5 * STEP * problem.certify
    dated = with_events_dated(wrong, replace(fitted, residual=residual))
    assert rmse(dated.residual, problem.certify) > 0.42 * STEP


@pytest.mark.slow
def test_a_date_is_not_replaced_by_a_worse_one():
    problem, fitted = stepped(certified(0.5), certified(0.5))
    whole = problem.whole()
    costs = [cost_of(fitted.residual, fitted.coordinates, whole)]
    for _ in range(3):
        fitted = with_events_dated(problem, fitted)
        costs.append(cost_of(fitted.residual, fitted.coordinates, whole))
    assert costs == sorted(costs, reverse=True)
