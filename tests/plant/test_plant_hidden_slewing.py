"""Hidden slew limits of the command against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN, TIME = UNEVEN.low, UNEVEN.high, UNEVEN.span, UNEVEN.time
U = command()
U[0] += 0.01
T = np.arange(U.size) * SUBSTEP
SIDES = pytest.mark.parametrize("side", [-1.0, 1.0])
EACH = pytest.mark.parametrize("share", SHARES)


def limited(form, size, share, conditions=UNEVEN):
    """Return a form's law, its draws and its rate, which is a range in ``size`` band periods."""
    made, defining, draws = drawn(form, size, share, conditions)
    rate = SPAN / (size * conditions.time)
    assert defining == {"rate": pytest.approx(rate)}
    assert not made.output
    return made, draws, rate


def step(made, start, change, samples, wait=50):
    """Return the way from the start in the direction of a step, after each sub-step from it on."""
    passed = through(made, np.repeat([start, start + change], [wait, samples]))
    np.testing.assert_allclose(passed[:wait], start, rtol=1e-12)
    return (passed[wait:] - start) * np.sign(change)


@EACH
@SIDES
def test_a_differential_pair_lags_behind_a_ramp_by_the_inverse_tanh(share, side):
    _, draws, rate = limited("differential_pair", 0.5, share)
    limit = rate * draws.at(0.85, 1.2) ** side
    for part in (0.01, 0.5, 0.98):
        made = drawn("differential_pair", 0.5, share)[0]
        ramp = 2.0 + side * part * limit * T[:3000]
        late = side * (ramp - through(made, ramp))[-1]
        error = 4.0 * SUBSTEP * limit * np.arctanh(part)
        assert late == pytest.approx(error - part * limit * SUBSTEP, rel=1e-5)
    made = drawn("differential_pair", 0.5, share)[0]
    way = step(made, 2.0, 5.0 * side, 100)
    np.testing.assert_allclose(np.diff(way), limit * SUBSTEP, rtol=1e-9)
    assert way[0] == pytest.approx(limit * SUBSTEP)


@EACH
@SIDES
@pytest.mark.parametrize(("size", "distance"), [(0.5, 3.0), (3.0, 3.0), (3.0, 0.05)])
def test_a_trapezoid_of_speed_ends_exactly_at_its_target(share, side, size, distance):
    made, draws, rate = limited("trapezoidal_speed", size, share)
    rise = draws.at(0.02, 0.08) * size * TIME + 4.0 * SUBSTEP
    way = step(made, 2.0, side * distance, 2500)
    t = np.arange(1, 2501) * SUBSTEP
    # Twice a constant acceleration; between the two the rate, unless the way is too short for it.
    top = min(rate, np.sqrt(distance * rate / rise))
    ramp = top * rise / rate
    end = distance / top + ramp
    first = 0.5 * rate / rise * np.minimum(t, ramp) ** 2
    last = 0.5 * rate / rise * np.maximum(np.minimum(t, end) - end + ramp, 0.0) ** 2
    expected = first + top * np.clip(t - ramp, 0.0, end - ramp) - last
    np.testing.assert_allclose(way, expected, atol=1.5 * top * SUBSTEP)
    # A parabola in whole sub-steps ends within an eighth of their unit of it.
    assert way.max() <= distance + 0.126 * rate / rise * SUBSTEP**2
    assert way[-1] == pytest.approx(distance, rel=1e-9)
    speed = np.diff(way, prepend=0.0) / SUBSTEP
    assert speed.max() <= rate * (1.0 + 1e-9)
    assert np.abs(np.diff(speed)).max() <= rate / rise * SUBSTEP * (1.0 + 1e-6)


@EACH
def test_a_trapezoid_of_speed_brakes_before_it_turns(share):
    made, draws, rate = limited("trapezoidal_speed", 1.0, share)
    rise = draws.at(0.02, 0.08) * TIME + 4.0 * SUBSTEP
    before = round(2.0 * rise / SUBSTEP)
    passed = through(made, np.repeat([1.0, 9.0, 1.0], [1, before, 1000]))[1:]
    speed = np.diff(passed) / SUBSTEP
    turned = np.flatnonzero(speed <= 0.0)[0]
    assert (turned - before) * SUBSTEP == pytest.approx(rise, abs=2.1 * SUBSTEP)
    assert passed.max() - passed[before - 1] == pytest.approx(0.5 * rate * rise, abs=rate * SUBSTEP)


def clipped(signal, rise, fall, time):
    """Return a first-order lag, exact for held values, whose steps are clipped."""
    place, passed = signal[0], []
    for value in signal:
        wanted = value + (place - value) * np.exp(-SUBSTEP / time)
        place = np.clip(wanted, place - fall * SUBSTEP, place + rise * SUBSTEP)
        passed.append(place)
    return np.array(passed)


@pytest.mark.parametrize("time", [TIME, 3.0])
def test_the_follower_s_current_is_constant_downwards_alone(time):
    made, _, rate = limited("class_a_follower", 0.4, 0.3, UNEVEN._replace(time=time))
    expected = clipped(U, np.inf, rate, 0.005 * time)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@EACH
@pytest.mark.parametrize("size", [0.4, 2.0])
def test_the_servo_is_a_lag_with_a_clipped_rate(share, size):
    made, draws, rate = limited("rate_limited_servo", size, share)
    expected = clipped(U, rate, rate, draws.at(0.04, 0.15) * size * TIME)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@EACH
@SIDES
@pytest.mark.parametrize("size", [0.05, 6.0])
@pytest.mark.parametrize("rested", [True, False])
def test_the_motor_makes_a_step_whenever_it_may(share, side, size, rested):
    made, draws, rate = limited("stepping_motor", size, share)
    height = draws.at(0.0003, 0.001) * SPAN
    distance = 0.8 * SPAN
    way = step(made, 2.0, side * distance, 2000, wait=50 if rested else 1)
    # A motor that has rested makes its first step at once.
    count = np.arange(1, 2001) * SUBSTEP * rate / height
    early = 1.0 if rested else min(SUBSTEP * rate / height, 1.0)
    due = np.minimum(count + early, distance / height + 0.5)
    near = np.abs(due - np.rint(due)) < 1e-6
    expected = height * np.floor(due)
    np.testing.assert_allclose(way[~near], expected[~near], atol=1e-6 * height)
    assert abs(way[-1] - distance) <= 0.5 * height * (1.0 + 1e-6)


def test_the_motor_is_within_half_a_step_of_a_slow_command():
    made, draws, _ = limited("stepping_motor", 0.2, 1.0)
    slow = 2.0 + 0.05 * np.sin(2.0 * np.pi * T)
    height = draws.at(0.0003, 0.001) * SPAN
    error = through(made, slow) - slow
    assert np.abs(error).max() == pytest.approx(0.5 * height, rel=0.02)
    assert np.abs(error).max() <= 0.5 * height


def test_the_ramp_is_averaged_over_two_sub_steps_at_least():
    made, _, rate = limited("smoothed_ramp", 0.01, 0.0)
    bounded = clipped(U, rate, rate, 1e-9)
    expected = 0.5 * (bounded + np.append(U[0], bounded[:-1]))
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@EACH
@pytest.mark.parametrize("size", [0.4, 2.0])
def test_the_motor_is_switched_on_at_its_band_and_off_at_its_target(share, size):
    made, draws, rate = limited("switched_motor", size, share)
    band = draws.at(0.002, 0.008) * SPAN
    place, running, expected = U[0], 0.0, []
    for target in U:
        if not running and abs(target - place) > band:
            running = np.sign(target - place)
        if running:
            left = running * (target - place)
            place += running * min(max(left, 0.0), rate * SUBSTEP)
            running = running if left > rate * SUBSTEP else 0.0
        expected.append(place)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@EACH
@SIDES
def test_an_orifice_empties_in_a_finite_time(share, side):
    made, draws, rate = limited("orifice_flow", 1.0, share)
    opening, distance = draws.at(0.01, 0.06) * SPAN, 0.8 * SPAN
    t = np.arange(1, 1001) * SUBSTEP
    # At the full rate, then along the parabola of Torricelli's law.
    at_rate = (distance - opening) / rate
    root = np.maximum(1.0 - 0.5 * rate / opening * np.maximum(t - at_rate, 0.0), 0.0)
    expected = np.where(t < at_rate, rate * t, distance - opening * root**2)
    way = step(made, 2.0, side * distance, 1000)
    np.testing.assert_allclose(way, expected, atol=1.5 * rate * SUBSTEP)
    np.testing.assert_allclose(np.diff(way[t < at_rate]), rate * SUBSTEP, rtol=1e-9)
    assert way[-1] == pytest.approx(distance, rel=1e-12)
    for part in (0.3, 0.9):
        made = drawn("orifice_flow", 1.0, share)[0]
        ramp = 2.0 + side * part * rate * T[:1500]
        late = side * (ramp - through(made, ramp))[-1]
        error = max(opening * part**2, part * rate * SUBSTEP)
        assert late == pytest.approx(error - part * rate * SUBSTEP, rel=1e-4, abs=1e-12)


@EACH
@SIDES
def test_the_current_folds_back_towards_the_end_it_moves_to(share, side):
    made, draws, rate = limited("foldback_current", 1.0, share)
    tilt, middle = draws.at(0.15, 0.4), 0.5 * (LOW + HIGH)
    way = step(made, middle - 0.8 * side * SPAN, 1.6 * side * SPAN, 1500)
    # Straight up to the range, exponential within it and straight beyond.
    level = np.clip((np.append(0.0, way[:-1]) - 0.8 * SPAN) / (0.5 * SPAN), -1.0, 1.0)
    speed = np.diff(way, prepend=0.0) / SUBSTEP
    moving = way < 1.6 * SPAN * (1.0 - 1e-9)
    np.testing.assert_allclose(speed[moving], (rate * (1.0 - tilt * level))[moving], rtol=1e-9)
    inside = np.flatnonzero(moving & (np.abs(level) < 0.999))[:-1]
    left = 0.5 * SPAN / tilt - (way[inside] - 0.8 * SPAN)
    decay = np.exp(-2.0 * tilt * rate / SPAN * SUBSTEP)
    np.testing.assert_allclose(left[1:] / left[:-1], decay, rtol=1e-4)
    assert way[-1] == pytest.approx(1.6 * SPAN, rel=1e-12)
