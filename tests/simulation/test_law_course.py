"""What a law does along a record, against the law written down anew."""

from dataclasses import replace

import numpy as np
import pytest
from made_wheel import wheel
from scipy.interpolate import make_interp_spline

from dea.simulation import (
    catalogue,
    law_courses,
    measured_scales,
    prepared,
)
from made_carriage import CARRIAGE

INTERVAL, SAMPLES = 0.02, 1000
SPRING = replace(CARRIAGE, accuracy=1e-3, input_interpolation="smooth")
TIME = np.arange(SAMPLES) * INTERVAL
U = np.sin(2 * np.pi * 0.2 * TIME) + 0.4 * np.sin(2 * np.pi * 0.47 * TIME)


class Sampled:
    u, y, interval = U, U, INTERVAL


def attached(*laws, lengths=(), upstream=False, simulation=SPRING):
    """A simulation with laws of these names and changed parameters, and all its values."""
    extended = prepared(simulation, U, INTERVAL, 1e-5, lengths)
    scales = measured_scales(extended, extended.layout.prior_means, Sampled())
    for name, _ in laws:
        extended = extended.attach(catalogue()[name], scales, upstream=upstream)
    values = np.array([p.nominal for p in extended.layout.parameters])
    for (_, changed), own in zip(laws, extended.layout.effect_slices, strict=True):
        names = [p.name.partition(".")[2] for p in extended.layout.parameters[own]]
        for name, value in changed.items():
            values[own.start + names.index(name)] = value
    return extended, values


def test_a_law_on_the_input_is_shown_over_the_input():
    hard = {"threshold": 0.5, "corner_width": 1e-3, "slope": 1.0, "gate": 0.0}
    [course] = law_courses(*attached(("dead_zone", hard)), U, INTERVAL)
    np.testing.assert_array_equal(course.along.values, U)
    np.testing.assert_array_equal(course.idle, U)
    expected = np.sign(U) * np.maximum(np.abs(U) - 0.5, 0.0)
    np.testing.assert_allclose(course.value.values, expected, atol=2e-3)
    assert (course.along.unit, course.value.unit) == ("V", "V")


def test_laws_are_shown_in_the_order_in_which_they_act():
    laws = ("dead_zone", {"threshold": 0.5}), ("input_saturation", {})
    first, second = law_courses(*attached(*laws), U, INTERVAL)
    np.testing.assert_array_equal(second.along.values, first.value.values)
    first, second = law_courses(*attached(*laws, upstream=True), U, INTERVAL)
    np.testing.assert_array_equal(first.along.values, second.value.values)


def test_a_loop_is_shown_over_the_position():
    stops = {"stiffness": 0.3, "largest_radius": 0.2}
    extended, values = attached(("rate_independent_hysteresis", stops))
    [course] = law_courses(extended, values, U, INTERVAL)
    position = extended.simulate(values, U, INTERVAL)
    np.testing.assert_allclose(course.along.values, position, atol=1e-9)
    assert course.along.unit == "V"


def test_a_force_that_does_not_look_at_the_position_is_shown_over_the_velocity():
    extended, values = attached(("coulomb_friction", {"force": 0.2, "slip_deflection": 1e-4}))
    [course] = law_courses(extended, values, U, INTERVAL)
    position = extended.simulate(values, U, INTERVAL)
    np.testing.assert_allclose(course.along.values, np.gradient(position, INTERVAL), atol=1e-9)
    moving = np.abs(course.along.values) > 0.3
    expected = -0.2 * np.sign(course.along.values[moving])
    assert np.mean(np.isclose(course.value.values[moving], expected, rtol=0.05)) > 0.95
    assert course.along.unit == "V/s"


def assert_pushes(course, extended, pushed):
    """The force is that which the motion lacks, after the second of the start."""
    [unit] = extended.normalisations
    error = (course.value.values * unit.unit_force - pushed)[50:]
    assert np.std(error) < 0.05 * np.std(pushed[50:])


@pytest.mark.parametrize("frequency", [1.0, 2.5])
def test_a_second_mass_pulls_as_the_motion_of_the_first_one_tells(frequency):
    extended, values = attached(("second_mode", {"frequency": frequency}))
    [course] = law_courses(extended, values, U, INTERVAL)
    motion = make_interp_spline(TIME, extended.simulate(values, U, INTERVAL), 5)
    slope, pushed = np.empty(2), np.empty(SAMPLES)
    for k, t in enumerate(TIME):
        state = np.array([motion(t), motion(t, 1)])
        SPRING.compiled_derivative(state, U[k], SPRING.nominal, slope)
        pushed[k] = motion(t, 2) - slope[1]
    assert_pushes(course, extended, pushed)


@pytest.mark.parametrize("name", ["coulomb_friction", "second_mode"])
def test_where_a_velocity_alone_is_known_a_force_is_shown_over_it(name):
    """The wheel's speed is its output, and friction its only force apart from the drag."""
    extended, values = attached((name, {}), simulation=wheel(input_interpolation="smooth"))
    [course] = law_courses(extended, values, U, INTERVAL)
    speed = extended.simulate(values, U, INTERVAL)
    assert (course.along.name, course.along.unit) == ("speed", "m/s")
    np.testing.assert_allclose(course.along.values, speed, atol=0.01 * np.ptp(speed))
    pushed = np.gradient(speed, INTERVAL) - (2.0 * U - speed) / 0.2
    assert_pushes(course, extended, pushed)


def test_a_force_of_the_position_is_shown_over_the_position():
    extended, values = attached(("strain_stiffening", {}))
    [course] = law_courses(extended, values, U, INTERVAL)
    position = extended.simulate(values, U, INTERVAL)
    np.testing.assert_allclose(course.along.values, position, atol=1e-9)
    np.testing.assert_array_equal(course.idle, np.zeros(SAMPLES))


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("stress_relaxation", {"relaxation": 0.5, "time": 2.0, "exponent": 0.8, "prestress": 0.3}),
        ("second_mode", {"frequency": 0.8, "damping_ratio": 0.1, "start_position": 0.4}),
    ],
)
def test_a_memory_of_time_has_gone_through_the_lead_in(name, law):
    """A lead-in of two seconds is a record that begins two seconds earlier with its first input."""
    extended, values = attached((name, law))
    lead = round(2.0 / INTERVAL)
    settled = replace(extended, simulation=replace(extended.simulation, lead_in=2.0))
    longer = np.concatenate([np.full(lead, U[0]), U])
    [expected] = law_courses(extended, values, longer, INTERVAL)
    [without] = law_courses(extended, values, U, INTERVAL)
    [found] = law_courses(settled, values, U, INTERVAL)
    for axis in ("along", "value"):
        whole = getattr(expected, axis).values[lead:]
        np.testing.assert_allclose(getattr(found, axis).values, whole, rtol=1e-9, atol=1e-12)
    change = found.value.values - without.value.values
    assert np.abs(change[:50]).max() > 0.1 * np.ptp(found.value.values)


def test_creep_is_shown_as_the_stiffness_that_it_loses_after_a_step():
    """As its compiled force loses it, from when the motion could have crossed its range."""
    law = {"stiffness": 0.1, "branch_3": 1.0}
    extended, values = attached(("viscoelastic_creep", law))
    [course] = law_courses(extended, values, U, INTERVAL)
    effect, scales = extended.attached[0].effect, extended.attached[0].scales
    q, step, h = values[extended.layout.effect_slices[0]], 1e-4, 1e-3
    memory, held = effect.memory(q), scales.z_middle + step
    effect.update(scales.z_middle, held, h, memory, q)
    force = []
    for _ in range(round(SAMPLES * INTERVAL / h)):
        force.append(effect.force(held, 0.0, memory, q))
        effect.update(held, held, h, memory, q)
    early = round(scales.crossing / h)
    lost = (np.array(force) - force[early]) / step
    times, size = course.along.values, course.value.values.max()
    assert (times[0], times[-1]) == pytest.approx((scales.crossing, scales.duration))
    expected = np.interp(times, h * (1 + np.arange(len(force))), lost)
    np.testing.assert_allclose(course.value.values, expected, atol=0.02 * size)
    assert size > 0.05


def test_a_loop_begins_with_the_record_and_not_with_the_lead_in():
    stops = {"stiffness": 0.3, "largest_radius": 0.2}
    extended, values = attached(("rate_independent_hysteresis", stops))
    settled = replace(extended, simulation=replace(extended.simulation, lead_in=2.0))
    [whole] = settled.motions(values, U + 0.5, INTERVAL)
    lead = whole.shape[1] - SAMPLES
    assert lead == 100
    assert np.ptp(whole[1, :lead]) > 0.3
    [found] = law_courses(settled, values, U + 0.5, INTERVAL)
    [expected] = law_courses(extended, values, U + 0.5, INTERVAL, [whole[:, lead:]])
    np.testing.assert_allclose(found.value.values, expected.value.values, atol=1e-12)


def test_what_changes_with_time_is_shown_over_time():
    for name, at_rest in (("gain_drift", 1.0), ("baseline_drift", 0.0)):
        [course] = law_courses(*attached((name, {"mode_1": 0.3})), U, INTERVAL)
        np.testing.assert_array_equal(course.along.values, TIME)
        assert np.ptp(course.value.values) > 0.0
        np.testing.assert_array_equal(course.idle, np.full(SAMPLES, at_rest))


@pytest.mark.parametrize(
    ("steps", "shown", "size"),
    [
        ({"gain_step": -0.4}, "factor on", 0.4),
        ({"gain_step": -0.4, "offset_step": 0.01}, "factor on", 0.4),
        ({"offset_step": 0.3}, "change of the reading", 0.3),
        ({"offset_step": 0.3, "gain_step": -0.01}, "change of the reading", 0.3),
        ({"highest_input": 0.1, "offset_step": 0.01}, "change of the input", U.max() - 0.1),
    ],
)
def test_a_step_is_shown_where_it_changes_more(steps, shown, size):
    law = {"instant": 10.0, "gain_step": 0.0, "offset_step": 0.0, "scale_step": 0.0} | steps
    [course] = law_courses(*attached(("step_fault", law)), U, INTERVAL)
    assert course.value.name.startswith(shown)
    np.testing.assert_array_equal(course.along.values, TIME)
    assert np.ptp(course.value.values) == pytest.approx(size, rel=1e-6)


def test_a_law_on_the_reading_is_shown_over_the_output():
    extended, values = attached(("sensor_lag", {}))
    [course] = law_courses(extended, values, U, INTERVAL)
    reading = extended.simulate(values, U, INTERVAL)
    np.testing.assert_allclose(course.value.values, reading, rtol=1e-9)
    alone = extended.without(0)
    output = alone.simulate(values[: extended.layout.effect_slices[0].start], U, INTERVAL)
    np.testing.assert_allclose(course.along.values, output, rtol=1e-9)


def test_records_are_shown_one_after_the_other():
    half = SAMPLES // 2
    extended, values = attached(("strain_stiffening", {}), lengths=(half, half))
    [course] = law_courses(extended, values, U, INTERVAL)
    together = extended.simulate(values, U, INTERVAL)
    np.testing.assert_allclose(course.along.values, together, atol=1e-9)


@pytest.mark.parametrize("name", catalogue())
def test_every_law_of_the_catalogue_has_a_shape(name):
    [course] = law_courses(*attached((name, {})), U, INTERVAL)
    assert np.isfinite(course.value.values).all()
    assert course.along.values.shape == course.value.values.shape == course.idle.shape == U.shape


@pytest.mark.parametrize("lead_in", [0.0, 1.0])
def test_the_courses_of_two_records_are_those_of_each_alone(lead_in):
    laws = ("dead_zone", {"threshold": 0.5}), ("sensor_lag", {}), ("viscoelastic_creep", {})
    joint, values = attached(*laws, lengths=(600, 400))
    joint = replace(joint, simulation=replace(joint.simulation, lead_in=lead_in))
    courses = law_courses(joint, values, U, INTERVAL)
    assert joint.records == 2
    for course, *parts in zip(
        courses,
        *(
            law_courses(joint.alone, own, U[part], INTERVAL)
            for part, own in joint.of_each_record(values)
        ),
        strict=True,
    ):
        for axis in ("along", "value"):
            whole = np.concatenate([getattr(each, axis).values for each in parts])
            np.testing.assert_array_equal(getattr(course, axis).values, whole)


def test_a_hum_is_shown_as_what_it_adds_to_the_reading():
    hum = {"sine_1": 0.3, "frequency": 1.7}
    extended, values = attached(("periodic_disturbance", hum))
    plain, own = attached()
    [course] = law_courses(extended, values, U, INTERVAL)
    added = extended.simulate(values, U, INTERVAL) - plain.simulate(own, U, INTERVAL)
    assert np.ptp(added) > 0.1
    np.testing.assert_allclose(course.value.values, added, atol=1e-9)


def test_of_an_event_one_quantity_is_shown_for_all_records():
    """That which it changes most in any; the same where courses are compared with those."""
    steps = {"gain_step": -0.4, "record_2.gain_step": 0.0, "record_2.offset_step": 0.05}
    joint, values = attached(("step_fault", steps | {"record_2.instant": 5.0}), lengths=(600, 400))
    [course] = law_courses(joint, values, U, INTERVAL)
    assert course.quantity == "drive"
    np.testing.assert_allclose(course.value.values[-400:], 1.0)
    alone, own = attached(("step_fault", {"gain_step": -0.4}))
    moved = own.copy()
    moved[alone.layout.names.index("step_fault.offset_step")] = 9.0
    assert law_courses(alone, moved, U, INTERVAL)[0].quantity == "reading"
    like = law_courses(alone, own, U, INTERVAL)
    [same] = law_courses(alone, moved, U, INTERVAL, like=like)
    np.testing.assert_array_equal(same.value.values, like[0].value.values)
