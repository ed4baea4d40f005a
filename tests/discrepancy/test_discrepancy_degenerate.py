"""Laws that explain a record only where they are no longer what they are called."""

from dataclasses import replace

import numpy as np
import pytest
from made_resonator import INTERVAL, NOISE, hidden

from dea.discrepancy.budget import Budget
from dea.discrepancy.fitting.candidates import judged
from dea.discrepancy.fitting.fit import fit
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.degenerate import unfinish_degenerate
from dea.discrepancy.search.rounds import Round, extend_by_each
from dea.discrepancy.search.search import Search, pool_of
from dea.simulation import (
    catalogue,
    measured_scales,
)


@pytest.mark.slow
@pytest.mark.parametrize("relaxes", [True, False])
@pytest.mark.parametrize(
    ("name", "drift"), [("stress_relaxation", 0.2), ("viscoelastic_creep", 0.1)]
)
def test_a_drift_does_not_bear_the_name_of_a_relaxation(name, drift, relaxes):
    """A prestress lost alone is a force that drifts; the stress must relax, or answer motion."""
    problem, extended = hidden(*[name] * relaxes)
    if not relaxes:
        late = (problem.time / 10.0) ** 0.8
        problem = replace(problem, y=problem.y + drift * (1.0 - np.exp(-late)))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effect = catalogue()[name]
    alone = extend_by_each(problem, [nominal], [effect], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 1.5 * NOISE
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == relaxes


@pytest.mark.parametrize("leaks", [True, False])
def test_a_bent_input_does_not_bear_the_name_of_a_leak(leaks):
    """A charge that is lost at once bends the input's curve."""
    problem, extended = hidden(*["charge_leakage"] * leaks)
    if not leaks:
        own = extended.layout.prior_means
        curved = problem.u * (1.0 - 0.1 * np.exp(3.0 * (np.abs(problem.u) / 2.0 - 1.0)))
        noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
        problem = replace(problem, y=extended.simulate(own, curved, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    effect = catalogue()["charge_leakage"]
    alone = extend_by_each(problem, [nominal], [effect], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 0.7 * problem.seen_rmse(nominal.residual)
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == leaks


def limited_since(since, begun):
    """Whether a limit since that time (s) keeps the name of an event, fitted from another time."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    limited = np.where(problem.time >= since, np.minimum(problem.u, 1.2), problem.u)
    noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
    problem = replace(problem, y=extended.simulate(own, limited, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    scales = replace(measured_scales(extended, nominal.values, problem), jumps=(19.0,))
    law = extended.attach(catalogue()["step_fault"], scales)
    low, high = problem.u.min(), problem.u.max()
    start = (begun, 0.0, 0.0, 0.1, 0.0, 1.3, low, 0.0, low, high, 6.0, 1.2, 0.0)
    found = fit(problem, law, law.layout.coordinates(np.concatenate([nominal.values, start])))
    assert problem.seen_rmse(found.residual) < 2.0 * NOISE
    candidate = judged(problem, found)
    [judged_again] = unfinish_degenerate(problem, [Round(nominal, (candidate,))], Rules(), NOISE, 1)
    return judged_again.candidates[0].finished


@pytest.mark.parametrize("since", [0.0, 20.0])
def test_a_limit_from_the_start_does_not_bear_the_name_of_an_event(since):
    assert limited_since(since, since + 0.7) == (since > 0.0)


@pytest.mark.parametrize(("since", "begun"), [(0.0, 0.45), (20.0, 20.7)])
def test_an_event_in_the_first_fiftieth_of_a_record_is_one_from_the_start(
    since, begun, monkeypatch
):
    """Even if it explains more than from the start on, as the state at the start may."""
    monkeypatch.setattr("dea.discrepancy.search.degenerate._explains_as_much", lambda *_: False)
    assert limited_since(since, begun) == (since > 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("threshold", [True, False])
def test_a_power_of_the_input_does_not_bear_the_name_of_a_threshold(threshold):
    """A heater's power goes with the square of its voltage, from zero on."""
    problem, extended = hidden(*["dead_zone"] * threshold)
    if not threshold:
        own = extended.layout.prior_means
        squared = problem.u * np.abs(problem.u) / 2.0
        noise = problem.y - extended.simulate(own, problem.u, INTERVAL)
        problem = replace(problem, y=extended.simulate(own, squared, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    alone = extend_by_each(problem, [nominal], [catalogue()["dead_zone"]], Budget(), 1)
    assert alone.candidates[0].finished
    assert alone.candidates[0].rmse < 1.2 * NOISE
    [judged_again] = unfinish_degenerate(problem, [alone], Rules(), NOISE, 1)
    assert judged_again.candidates[0].finished == threshold


@pytest.mark.slow
@pytest.mark.parametrize("relaxes", [True, False])
def test_a_law_loses_its_name_beside_one_that_keeps_its_own(relaxes):
    problem, extended = hidden("dead_zone", *["stress_relaxation"] * relaxes)
    if not relaxes:
        late = (problem.time / 10.0) ** 0.8
        problem = replace(problem, y=problem.y + 0.2 * (1.0 - np.exp(-late)))
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("dead_zone", "stress_relaxation")]
    rounds = Search(problem, [nominal], offered, Budget(), Rules(), 1).rounds()
    best = pool_of(rounds)[0]
    assert best.effects == {"dead_zone", "stress_relaxation"}
    assert best.rmse < 1.5 * NOISE
    judged_again = pool_of(unfinish_degenerate(problem, rounds, Rules(), NOISE, 1))
    assert [c.finished for c in judged_again if c.effects == best.effects] == [relaxes]


@pytest.mark.parametrize("limited", [True, False])
def test_a_gently_bent_reading_does_not_bear_the_name_of_a_limit(limited):
    """An arm that turns reads the sine of its angle; a rail ends the reading."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    y = extended.simulate(own, problem.u, INTERVAL)
    noise = NOISE * np.random.default_rng(4).standard_normal(y.size)
    far = np.abs(y).max()
    bent = np.minimum(y, 0.7 * far) if limited else far / 0.8 * np.sin(0.8 * y / far)
    problem = replace(problem, y=bent + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    offered = [catalogue()[name] for name in ("output_saturation", "sensor_nonlinearity")]
    singles = extend_by_each(problem, [nominal], offered, Budget(), 1)
    [again] = unfinish_degenerate(problem, [singles], Rules(), NOISE, 1)
    finished = {c.names[0] for c in again.candidates if c.finished}
    assert ("output_saturation" in finished) == limited
    assert {c.names[0]: c.rmse < 1.2 * NOISE for c in again.candidates}["output_saturation"]


@pytest.mark.parametrize("limited", [True, False])
def test_a_gently_bent_command_does_not_bear_the_name_of_a_limit(limited):
    """Nothing else is a curve of the command, so that nothing else explains it."""
    problem, extended = hidden()
    own = extended.layout.prior_means
    peak = np.abs(problem.u).max()
    bent = np.clip(problem.u, -0.7 * peak, 0.7 * peak)
    if not limited:
        bent = problem.u * (1.0 - 0.12 * np.abs(problem.u) / peak)  # the slope falls to 0.76
    noise = NOISE * np.random.default_rng(4).standard_normal(problem.y.size)
    problem = replace(problem, y=extended.simulate(own, bent, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    singles = extend_by_each(problem, [nominal], [catalogue()["input_saturation"]], Budget(), 1)
    [again] = unfinish_degenerate(problem, [singles], Rules(), NOISE, 1)
    [found] = again.candidates
    assert found.finished is limited
    assert found.rmse < 1.2 * NOISE


def test_what_leads_once_others_have_fallen_is_tested_too():
    problem, extended = hidden()
    own = extended.layout.prior_means
    bent = problem.u * (1.0 - 0.12 * np.abs(problem.u) / np.abs(problem.u).max())
    noise = NOISE * np.random.default_rng(4).standard_normal(problem.y.size)
    problem = replace(problem, y=extended.simulate(own, bent, INTERVAL) + noise)
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    singles = extend_by_each(problem, [nominal], [catalogue()["input_saturation"]], Budget(), 1)
    [found] = singles.candidates
    rules = Rules()
    further = replace(found, error=2.0 * rules.near * found.error)
    singles = replace(singles, candidates=(found, further))
    [again] = unfinish_degenerate(problem, [singles], rules, NOISE, 1)
    assert [c.finished for c in again.candidates] == [False, False]
