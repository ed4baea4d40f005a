"""Bands of a law over the record, against sums and draws made here."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.stats import norm

from dea.discrepancy.evidence.law_bands import banded_laws, in_port_unit
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Samples
from dea.simulation import catalogue, law_courses, measured_scales, prepared
from made_carriage import CARRIAGE

INTERVAL = 0.02
TIME = np.arange(600) * INTERVAL
U = np.sin(2 * np.pi * 0.2 * TIME) + 0.4 * np.sin(2 * np.pi * 0.47 * TIME)
RECORD = Samples(U, U, INTERVAL)
RNG = np.random.default_rng(4)


def extended_by(*names, simulation=CARRIAGE):
    extended = prepared(simulation, U, INTERVAL, 1e-4)
    scales = measured_scales(extended, extended.layout.prior_means, RECORD)
    for name in names:
        extended = extended.attach(catalogue()[name], scales)
    coordinates = np.zeros(extended.layout.free.size)
    return Fit(extended, coordinates, np.zeros(U.size), np.zeros((U.size, coordinates.size)), 0.0)


def correlated(size, scale):
    """A covariance of this many coordinates, none of them independent of the others."""
    root = RNG.standard_normal((size, size))
    return scale**2 * (root @ root.T / size + 0.2 * np.eye(size))


def own_part(fit, index):
    where = fit.extended.layout.effect_slices[index]
    return np.flatnonzero(
        (fit.extended.layout.free >= where.start) & (fit.extended.layout.free < where.stop)
    )


def courses_of(fit, coordinates):
    """The courses of laws elsewhere, on the motion of the fit."""
    extended = fit.extended
    motions = extended.motions(fit.values, U, INTERVAL)
    return law_courses(extended, extended.layout.values(coordinates), U, INTERVAL, motions)


def test_the_band_of_a_law_that_is_linear_in_its_parameters_is_exact():
    fit = extended_by("gain_drift")
    own, C = own_part(fit, 0), correlated(fit.coordinates.size, 0.3)
    [law] = banded_laws(RECORD, fit, C)
    columns = []
    for position in own:
        moved = fit.coordinates.copy()
        moved[position] = 1.0
        columns.append(courses_of(fit, moved)[0].value.values - law.course.value.values)
    J = np.column_stack(columns)
    half = norm.ppf(0.975) * np.sqrt(np.einsum("ni,ij,nj->n", J, C[np.ix_(own, own)], J))
    assert half.max() > 1e-3
    np.testing.assert_allclose(law.high - law.course.value.values, half, atol=1e-9)
    np.testing.assert_allclose(law.course.value.values - law.low, half, atol=1e-9)


def test_the_band_of_a_bent_law_is_that_of_draws():
    fit = extended_by("gain_drift", "strain_stiffening")
    own, C = own_part(fit, 1), correlated(fit.coordinates.size, 0.1)
    law = banded_laws(RECORD, fit, C)[1]
    drawn = []
    for draw in RNG.multivariate_normal(np.zeros(own.size), C[np.ix_(own, own)], 1000):
        moved = fit.coordinates.copy()
        moved[own] += draw
        drawn.append(courses_of(fit, moved)[1].value.values)
    low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
    size = np.max(high - low)
    assert size > 1e-3
    np.testing.assert_allclose(law.low, low, atol=0.06 * size)
    np.testing.assert_allclose(law.high, high, atol=0.06 * size)


def test_a_parameter_at_its_bound_widens_the_band_to_one_side():
    fit = extended_by("dead_zone")
    names = [fit.extended.layout.names[i] for i in fit.extended.layout.free]
    at = names.index("dead_zone.gate")
    fit.coordinates[at] = fit.extended.layout.bounds[0][at]
    C = np.zeros((fit.coordinates.size,) * 2)
    C[at, at] = 0.1
    [law] = banded_laws(RECORD, fit, C)
    value = law.course.value.values
    above, below = law.high - value, value - law.low
    assert np.max(np.maximum(above, below)) > 1e-2
    np.testing.assert_array_equal(np.minimum(above, below), 0.0)


def test_a_law_without_a_course_has_no_band_and_the_others_keep_theirs():
    fit = extended_by("coulomb_friction", "dead_zone")
    [port], [frame] = CARRIAGE.force_ports, fit.extended.normalisations
    other = replace(port, reaction=port.position)
    two = replace(CARRIAGE, force_ports=(port, other))
    elsewhere, zone = fit.extended.attached
    extended = replace(
        fit.extended, simulation=two, normalisations=(frame, frame),
        attached=(replace(elsewhere, place=1), zone),
    )  # fmt: skip
    fit = replace(fit, extended=extended)
    friction, zone = banded_laws(RECORD, fit, correlated(fit.coordinates.size, 0.1))
    assert friction is None
    np.testing.assert_array_equal(zone.course.along.values, U)
    assert np.max(zone.high - zone.low) > 0.0


@pytest.mark.parametrize(
    "name", ["coulomb_friction", "rate_independent_hysteresis", "strain_stiffening"]
)
def test_the_course_of_a_force_is_that_in_the_middle_of_its_steps(name):
    fit = extended_by(name)
    fit = replace(fit, coordinates=np.full(fit.coordinates.size, 0.3))
    [course] = courses_of(fit, fit.coordinates)
    effect = catalogue()[name]
    q = fit.values[fit.extended.layout.effect_slices[0]]
    law, memory = np.zeros(32), np.zeros(32)
    law[: q.size] = q
    if effect.memory is not None:
        memory = effect.memory(q)
    z = fit.extended.run(fit.values, U, INTERVAL)[1]
    h = INTERVAL / effect.refine
    halves = CubicSpline(np.arange(z.size), z)(np.arange(0, z.size - 0.9, 0.5 / effect.refine))
    effect.update(z[0], z[0], 0.5 * h, memory, law)
    pushes = []
    for start, middle, end in zip(halves[:-2:2], halves[1:-1:2], halves[2::2], strict=True):
        pushes.append(effect.force(middle, (end - start) / h, memory, law))
        effect.update(start, end, h, memory, law)
    middles = (np.arange(len(pushes)) + 0.5) / effect.refine
    expected = np.interp(np.arange(z.size), middles, pushes)
    error = course.value.values - expected
    assert np.abs(error).max() < 1e-3 * np.ptp(expected)


def test_the_band_of_an_event_is_of_what_is_shown():
    """Before the event nothing is uncertain, whatever else the event might do after it."""
    fit = extended_by("step_fault")
    names = [fit.extended.layout.names[i] for i in fit.extended.layout.free]
    moved = fit.coordinates.copy()
    moved[names.index("step_fault.gain_step")] = 1.0
    [law] = banded_laws(RECORD, replace(fit, coordinates=moved), np.eye(moved.size))
    assert law.course.quantity == "drive"
    instant = law.course.along.values[np.argmax(np.diff(law.course.value.values) != 0.0)]
    before = law.course.along.values < instant - 0.25 * np.ptp(law.course.along.values)
    assert before.any()
    np.testing.assert_allclose(law.low[before], 1.0, atol=1e-12)
    np.testing.assert_allclose(law.high[before], 1.0, atol=1e-12)


def test_a_force_is_drawn_in_the_unit_that_its_parameters_are_told_in():
    """The carriage's equation is of a velocity in V/s: its forces are in V/s^2."""
    fit = extended_by("coulomb_friction", "dead_zone")
    extended = fit.extended
    friction, zone = banded_laws(RECORD, fit, correlated(fit.coordinates.size, 0.1))
    defining = extended.attached[0].effect.defining
    parameter = next(p for p in extended.attached[0].parameters if p.name == defining)
    _, size, unit = extended.places.own_unit(extended.attached[0], parameter)
    assert size != 1.0
    law = in_port_unit(friction, extended, extended.attached[0])
    assert (law.course.value.unit, law.course.value.name) == (unit, "force") == ("V/s^2", "force")
    for scaled, own in (
        (law.course.value.values, friction.course.value.values),
        (law.low, friction.low),
        (law.high, friction.high),
        (law.course.idle, friction.course.idle),
    ):
        np.testing.assert_allclose(scaled, size * own)
    assert in_port_unit(zone, extended, extended.attached[1]) is zone
    bare = replace(extended.normalisations[0], unit_force=0.0)
    none = replace(extended, normalisations=(bare,))
    assert in_port_unit(friction, none, extended.attached[0]) is friction


def test_a_stiffness_that_relaxes_is_drawn_in_the_unit_that_it_is_told_in():
    fit = extended_by("viscoelastic_creep")
    extended = fit.extended
    [creep] = banded_laws(RECORD, fit, correlated(fit.coordinates.size, 0.1))
    stiffness = next(p for p in extended.attached[0].parameters if p.name == "stiffness")
    _, size, unit = extended.places.own_unit(extended.attached[0], stiffness)
    assert size != 1.0
    law = in_port_unit(creep, extended, extended.attached[0])
    assert (law.course.value.unit, law.course.value.name) == (unit, "relaxed stiffness")
    assert unit != "1"
    np.testing.assert_allclose(law.course.value.values, size * creep.course.value.values)
    np.testing.assert_allclose(law.high, size * creep.high)
    assert np.ptp(law.course.value.values) > 0.0
