"""Kernels that hidden laws share: curves, courses in time, rings of past values, filters."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import UNEVEN, Draws
from scipy.signal import lfilter

from dea.plant.film import SUBSTEP
from dea.plant.hidden.forms import kernels

LOW, HIGH, TRAVEL = UNEVEN.low, UNEVEN.high, UNEVEN.travel
SIGNAL = np.random.default_rng(6).uniform(0.5, 4.0, 400)


@pytest.mark.parametrize(
    ("made", "first", "last", "output"),
    [
        (kernels.command_curve, 0.0, 2.0 * HIGH, False),
        (
            kernels.reading_curve,
            UNEVEN.bottom - 4.0 * TRAVEL,
            UNEVEN.top + 4.0 * TRAVEL,
            True,
        ),
    ],
)
def test_a_curve_is_interpolated_and_goes_on_along_its_last_pieces(made, first, last, output):
    law = made(lambda x: x**2, UNEVEN)
    assert law.output is output
    places = np.linspace(first, last, 8001)
    step = places[1] - places[0]
    inside = np.random.default_rng(3).uniform(first, last, 500)
    np.testing.assert_allclose(through(law, inside), np.interp(inside, places, places**2))
    beyond = np.array([0.5, 3.0, 700.0]) * step
    slope = last + places[-2]
    np.testing.assert_allclose(through(law, last + beyond), last**2 + slope * beyond, rtol=1e-9)
    before = np.array([-0.5, -3.0, -700.0]) * step
    slope = first + places[1]
    np.testing.assert_allclose(through(law, first + before), first**2 + slope * before, rtol=1e-9)


def test_a_curve_above_a_knee_changes_nothing_below():
    x = np.array([-3.0, 0.0, 1.9, 2.0, 2.5, 7.0])
    bent = kernels.bent_above(2.0, np.sqrt)(x)
    np.testing.assert_allclose(bent, [-3.0, 0.0, 1.9, 2.0, 2.0 + 0.5**0.5, 2.0 + 5.0**0.5])


@pytest.mark.parametrize("share", [0.0, 1.0])
@pytest.mark.parametrize(("size", "always_up"), [(0.49, False), (0.5, True), (1.4, True)])
def test_a_large_change_is_one_upwards(share, size, always_up):
    expected = 1.0 if always_up or share else -1.0
    assert kernels.sign(size, Draws(share)) == expected


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_a_course_of_the_gain_acts_on_what_drives_and_ends_with_the_record(power):
    duration, t = 0.3, np.arange(SIGNAL.size) * SUBSTEP
    law = kernels.gain_course(lambda t: -8.0 * t + 20.0 * t**2, duration, power)
    assert not law.output
    within = np.minimum(t, duration)
    driven = SIGNAL**power * np.maximum(1.0 - 8.0 * within + 20.0 * within**2, 0.0)
    np.testing.assert_allclose(through(law, SIGNAL) ** power, driven, atol=1e-6)
    lost = kernels.gain_course(lambda t: -20.0 * t, duration, power)
    passed = through(lost, SIGNAL)
    assert (passed[t > 0.051] == 0.0).all()
    assert (passed[t < 0.049] > 0.0).all()


def test_a_course_of_the_reading_is_added_and_ends_with_the_record():
    duration, t = 0.3, np.arange(SIGNAL.size) * SUBSTEP
    law = kernels.added_course(lambda t: 5.0 * t**2, duration)
    assert law.output
    expected = SIGNAL + 5.0 * np.minimum(t, duration) ** 2
    np.testing.assert_allclose(through(law, SIGNAL), expected, atol=1e-6)


def test_a_ring_returns_values_noted_before_and_at_first_the_first():
    ring, values = np.zeros(6), np.arange(3.0, 40.0)
    for k, value in enumerate(values):
        kernels.note(ring, value)
        for late in range(5):
            assert kernels.noted(ring, late) == values[max(k - late, 0)]


@pytest.mark.parametrize("output", [False, True])
def test_a_cascade_is_one_lag_after_the_other(output):
    times = np.array([0.004, 0.02, 0.0007])
    law = kernels.cascade(times, output=output)
    assert law.output is output
    expected = SIGNAL - SIGNAL[0]
    for time in times:
        # z steps by Euler's implicit rule.
        expected = lfilter([SUBSTEP], [time + SUBSTEP, -time], expected)
    np.testing.assert_allclose(through(law, SIGNAL), expected + SIGNAL[0], atol=1e-9)
    # The mean delay of an impulse is the sum of the times, of which none is lost to the steps.
    impulse = through(kernels.cascade(times), np.repeat([0.0, 1.0, 0.0], [1, 1, 900]))[1:]
    assert impulse @ np.arange(901) * SUBSTEP == pytest.approx(times.sum())


@pytest.mark.parametrize("settled", [None, True, False])
@pytest.mark.parametrize("output", [False, True])
def test_lags_side_by_side_begin_settled_unless_told_otherwise(settled, output):
    weights, times = np.array([0.7, -0.2, 0.1]), np.array([0.004, 0.02, 0.3])
    given = {} if settled is None else {"settled": settled}
    law = kernels.parallel(0.4, weights, times, output=output, **given)
    assert law.output is output
    first = 0.0 if settled is False else SIGNAL[0]
    expected = 0.4 * SIGNAL + weights.sum() * first
    for weight, time in zip(weights, times, strict=True):
        kept = np.exp(-SUBSTEP / time)
        expected += weight * lfilter([1.0 - kept], [1.0, -kept], SIGNAL - first)
    np.testing.assert_allclose(through(law, SIGNAL), expected, atol=1e-9)


def test_laws_without_a_word_act_on_the_command():
    assert not kernels.cascade(np.ones(1)).output
    assert not kernels.parallel(0.0, np.ones(1), np.ones(1)).output
