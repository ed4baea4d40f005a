"""What is predicted of blocks that a fit has not seen."""

from dataclasses import replace

import numpy as np
import pytest

from dea.discrepancy.evidence.held_out import HeldOut, folds
from dea.discrepancy.fitting.fit import Columns, fit
from dea.discrepancy.problem.problem import Problem, rmse
from dea.discrepancy.problem.split import split
from dea.missing import runs
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
    y = extended.simulate(extended.layout.prior_means, u, INTERVAL)
    y += STEP * (INTERVAL * np.arange(SIZE) >= instant) + NOISE * rng.standard_normal(SIZE)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    # The residual of the simulation alone may put the step a second late.
    scales = replace(measured_scales(extended, nominal.values, problem), jumps=(instant + 1.0,))
    law = extended.attach(catalogue()["step_fault"], scales)
    ends = u.min(), u.max()
    start = law.attached[0].started(
        (instant + 0.1, 0.0, STEP, 4 * INTERVAL, 0.0, *ends[::-1], 0.0, *ends, 6.0, 1.2, 0.0)
    )
    place = law.layout.coordinates(np.concatenate([nominal.values, start]))
    return problem, fit(problem, law, place, iterations=40), instant


def test_the_instant_of_an_event_is_that_of_the_fit_to_all_blocks(found):
    """Without its block nothing tells it, and the prior would move it by a second."""
    problem, fitted, instant = found
    own = dict(zip(fitted.extended.layout.names, fitted.values, strict=True))
    assert own["step_fault.instant"] == pytest.approx(instant, abs=2 * INTERVAL)
    dealt = folds(problem, fitted.records)
    [fold] = [each for each in dealt if each[round(instant / INTERVAL)]]
    held_out = HeldOut(problem).residual(fitted)
    assert rmse(held_out, fold) < 1.5 * rmse(fitted.residual, fold)


def test_the_size_of_an_event_is_told_by_the_other_blocks(found):
    problem, fitted, _ = found
    names = [fitted.extended.layout.names[i] for i in fitted.extended.layout.free]
    spread = HeldOut(problem).spread(fitted)
    assert spread[names.index("step_fault.instant")] == pytest.approx(0.0, abs=1e-12)
    assert spread[names.index("step_fault.offset_step")] > 0.0


def test_a_slope_that_a_limit_leaves_is_kept_where_one_block_alone_reaches_it():
    """Its prior mean, which the others leave, says that the limit lets nothing through."""
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(-1, 1, SIZE // 25), 25)
    parts = split(u, INTERVAL, 0.1)
    block = np.flatnonzero(parts.fit)[:60]
    u[block[10:40]] = 1.4
    extended = prepared(load_simulation("mass_spring_damper"), u, INTERVAL, 1e-4)
    plain = extended.simulate(extended.layout.prior_means, u, INTERVAL)
    limit, slope = np.delete(plain, np.s_[block[0] : block[-1] + 60]).max(), 0.3
    y = np.where(plain > limit, limit + slope * (plain - limit), plain)
    y += NOISE * rng.standard_normal(SIZE)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    law = extended.attach(
        catalogue()["output_saturation"], measured_scales(extended, nominal.values, problem)
    )
    own = {f"output_saturation.{name}": value for name, value in
           {"upper_end": limit, "sharpness": 100.0, "remaining_slope": slope}.items()}  # fmt: skip
    values = dict(zip(law.layout.names, law.layout.prior_means, strict=True)) | own
    place = law.layout.coordinates(np.array(list(values.values())))
    fitted = fit(problem, law, place, iterations=40)
    [fold] = [each for each in folds(problem) if each[block[20]]]
    held_out = HeldOut(problem).residual(fitted)
    assert rmse(fitted.residual, fold) < 1.5 * NOISE
    assert rmse(held_out, fold) < 2.0 * NOISE


@pytest.fixture(scope="module")
def drifting():
    """Return a problem with an input of three periods and a gain that drifts, and a fit of it."""
    rng = np.random.default_rng(2)
    u = np.tile(np.repeat(rng.uniform(-2, 2, SIZE // 75), 25), 3)
    extended = prepared(load_simulation("mass_spring_damper"), u, INTERVAL, 1e-4)
    time = INTERVAL * np.arange(SIZE)
    gain = 1.0 + 0.3 * np.sin(2.5 * np.pi * time / time[-1])
    y = extended.simulate(extended.layout.prior_means, gain * u, INTERVAL)
    y += NOISE * rng.standard_normal(SIZE)
    parts = split(u, INTERVAL, 0.1)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    law = extended.attach(
        catalogue()["gain_drift"], measured_scales(extended, nominal.values, problem)
    )
    return problem, fit(problem, law, np.zeros(law.layout.free.size), iterations=40)


@pytest.mark.slow
def test_a_course_in_time_is_interpolated_between_short_blocks(drifting):
    """A third of the record would be extrapolated, and say nothing against the right course."""
    problem, fitted = drifting
    assert problem.periods == (SIZE // 3,)
    assert problem.seen_rmse(fitted.residual) < 2.0 * NOISE
    assert problem.seen_rmse(HeldOut(problem).residual(fitted)) < 3.0 * NOISE


def test_what_a_course_is_compared_with_is_held_out_in_the_same_blocks(drifting):
    problem, fitted = drifting
    alone = fit(
        problem, fitted.extended.without(0), np.zeros(fitted.extended.layout.free.size)[:-12]
    )
    held_out = HeldOut(problem)
    long, short = held_out.residual(alone), held_out.residual(alone, fitted)
    assert not np.allclose(long, short)
    assert held_out.compared([alone, fitted]) == [problem.seen_rmse(short), held_out.rmse(fitted)]
    assert held_out.compared([alone]) == [problem.seen_rmse(long)]
    for fold in folds(problem, fitted.records):
        again = fit(
            problem.seeing(~fold),
            alone.extended,
            alone.coordinates,
            iterations=6,
            columns=Columns(held=alone.extended.layout.at_start, kept=alone.jacobian),
        )
        assert np.array_equal(short[fold], again.residual[fold])


def longest(masks):
    return max(run.stop - run.start for mask in masks for run in runs(mask))


@pytest.mark.parametrize("records", [1, 2, 4])
def test_short_blocks_are_a_tenth_of_their_record_and_dealt_once(records):
    """Blocks as long as the device's memory asks for are a fifth of such a record."""
    length = 600
    u = np.random.default_rng(3).uniform(-2, 2, length)
    parts = split(u, INTERVAL, 0.45)
    masks = (np.tile(mask, records) for mask in (parts.fit, parts.select, parts.certify))
    u = np.tile(u, records)
    problem = Problem(u, u, INTERVAL, *masks, NOISE)
    own = [slice(k * length, (k + 1) * length) for k in range(records)]
    dealt = folds(problem, own)
    assert (np.array(dealt).sum(0) == problem.seen).all()
    assert longest(dealt) <= 0.12 * length
    assert longest(folds(problem)) > 0.15 * length
