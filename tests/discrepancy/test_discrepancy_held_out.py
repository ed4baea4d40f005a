"""What is predicted of blocks that a fit has not seen."""

from dataclasses import replace

import numpy as np
import pytest

from dea.discrepancy.evidence.held_out import HeldOut, folds
from dea.discrepancy.evidence.split import split
from dea.discrepancy.fit import fit
from dea.discrepancy.problem import Problem, rmse
from dea.simulation import catalogue, load_simulation, measured_scales, prepared

INTERVAL, NOISE, STEP, SIZE = 0.02, 0.002, 0.4, 3000


@pytest.fixture(scope="module")
def found():
    """Return a problem in which the output is shifted within a block that is seen, and a fit."""
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(-2, 2, SIZE // 25), 25)
    extended = prepared(load_simulation("mass_spring_damper"), u, INTERVAL, 1e-4)
    parts = split(u, INTERVAL, 0.1)
    block = np.flatnonzero(parts.fit)[:60]
    instant = INTERVAL * block[40]
    y = extended.simulate(extended.values(np.zeros(extended.free.size)), u, INTERVAL)
    y += STEP * (INTERVAL * np.arange(SIZE) >= instant) + NOISE * rng.standard_normal(SIZE)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.free.size))
    # The residual of the simulation alone may put the step a second late.
    scales = replace(measured_scales(extended, nominal.values, problem), jumps=(instant + 1.0,))
    law = extended.attach(catalogue()["step_fault"], scales)
    start = law.attached[0].started((instant + 0.1, 0.0, STEP, 4 * INTERVAL, 0.0))
    place = law.coordinates(np.concatenate([nominal.values, start]))
    return problem, fit(problem, law, place, iterations=40), instant


def test_the_instant_of_an_event_is_that_of_the_fit_to_all_blocks(found):
    """Without its block nothing tells it, and the prior would move it by a second."""
    problem, fitted, instant = found
    own = dict(zip(fitted.extended.names, fitted.values, strict=True))
    assert own["step_fault.instant"] == pytest.approx(instant, abs=2 * INTERVAL)
    [fold] = [each for each in folds(problem) if each[round(instant / INTERVAL)]]
    held_out = HeldOut(problem).residual(fitted)
    assert rmse(held_out, fold) < 1.5 * rmse(fitted.residual, fold)


def test_the_size_of_an_event_is_told_by_the_other_blocks(found):
    problem, fitted, _ = found
    names = [fitted.extended.names[i] for i in fitted.extended.free]
    spread = HeldOut(problem).spread(fitted)
    assert spread[names.index("step_fault.instant")] == pytest.approx(0.0, abs=1e-12)
    assert spread[names.index("step_fault.offset_step")] > 0.0
