"""Hidden joints, drifts, faults, waves and foreign effects, each against another statement."""

from itertools import pairwise

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn, form
from scipy.integrate import solve_ivp

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN, TIME = UNEVEN.low, UNEVEN.high, UNEVEN.span, UNEVEN.time
BOTTOM, TOP, TRAVEL, LENGTH = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel, UNEVEN.duration
MIDDLE = 0.5 * (BOTTOM + TOP)
EACH = pytest.mark.parametrize("share", SHARES)
U = command()
T = np.arange(U.size) * SUBSTEP
MOTION = BOTTOM + TRAVEL * (U - LOW) / SPAN
RECORD = np.arange(round(LENGTH / SUBSTEP)) * SUBSTEP


@EACH
@pytest.mark.parametrize("size", [0.02, 0.2])
def test_a_load_bounces_between_its_flanks_until_drag_stops_it(share, size):
    made, defining, draws = drawn("rattling_joint", size, share)
    gap, decay = size * TRAVEL, draws.log(0.03, 0.3) * TIME
    bounce, speed = draws.at(0.3, 0.7), 20.0
    assert defining == {"gap": pytest.approx(gap)}
    # Its output pushes it upwards, and stops: it leaves the lower flank at that speed.
    pushed = BOTTOM + speed * np.arange(400) * SUBSTEP
    read = through(made, np.append(pushed, np.full(4000, pushed[-1])))
    place, v, side, t, expected = 0.0, speed, 1.0, 0.0, []
    moments = []
    while v > 0.05 and t < 4.0:
        reach = v * decay
        if reach < gap * (1.0 - 1e-9):
            moments.append((t, side, v, np.inf))
            break
        flight = -decay * np.log(1.0 - gap / reach)
        moments.append((t, side, v, flight))
        v *= np.exp(-flight / decay) * bounce
        t, side = t + flight, -side
    for k in range(1, 1500):
        now = (k + 0.0) * SUBSTEP
        t, side, v, flight = [m for m in moments if m[0] <= now][-1]
        flown = min(v * decay * (1.0 - np.exp(-(now - t) / decay)), gap)
        place = flown if side > 0.0 else gap - flown
        expected.append(pushed[-1] - 0.5 * gap + place)
    late = len(moments) + 2.0
    np.testing.assert_allclose(read[400:1899], expected, atol=late * speed * SUBSTEP)
    assert np.ptp(read[400:]) <= gap * (1.0 + 1e-9)


@EACH
@pytest.mark.parametrize("size", [0.02, 0.2])
def test_grease_is_squeezed_as_another_integrator_says(share, size):
    made, draws = form("greased_joint", size, share)
    half = 0.5 * size * TRAVEL
    film = draws.at(0.6, 1.2) * half
    turns = [MOTION[0], TOP, BOTTOM, MIDDLE, MIDDLE - 0.6 * half, TOP]
    path = np.concatenate([np.linspace(a, b, 800)[1:] for a, b in pairwise(turns)])
    path = np.append(turns[0], path)
    read = through(made, path)
    place, expected = 0.9 * (2.0 * share - 1.0) * half, []
    for k, (a, b) in enumerate(pairwise(turns)):
        side, way = np.sign(b - a), np.linspace(0.0, abs(b - a), 800)

        def closing(d, left):
            return -(left**3) / (left**3 + film**3)

        solved = solve_ivp(
            closing, (0.0, way[-1]), [half - side * place], t_eval=way, rtol=1e-10, atol=1e-12,
            method="LSODA",
        )  # fmt: skip
        within = side * (half - solved.y[0])
        expected.append((a + side * way - within)[1:] if k else a + side * way - within)
        place = within[-1]
    np.testing.assert_allclose(read, np.concatenate(expected), atol=1e-6 * TRAVEL)
    # However far, what is read is behind by less than half the gap.
    assert 0.6 * half < path[799] - read[799] < half


def changed(name, share, size=0.2):
    """Return the course that a drift takes, of the gain or of the reading."""
    made, draws = form(name, size, share)
    if made.output:
        return through(made, np.zeros(RECORD.size)) / TRAVEL, draws
    return through(made, np.ones(RECORD.size)) ** UNEVEN.power - 1.0, draws


@EACH
def test_a_gamma_process_never_turns_and_has_exponential_amounts(share):
    found, draws = changed("eroding_gain", share)
    side = draws.sign(0.2)
    count = min(30 + int(51 * share), 80)
    assert side * found[-1] == pytest.approx(0.2, rel=3e-3)
    amounts = np.diff(np.interp(np.linspace(0.0, LENGTH, count + 1), RECORD, side * found))
    drawn_ones = draws.exponential(1.0, count)
    np.testing.assert_allclose(amounts[:-1], 0.2 * (drawn_ones / drawn_ones.sum())[:-1], atol=3e-4)


@EACH
def test_an_oven_s_gain_is_that_of_a_regulator_of_second_order(share):
    found, draws = changed("oven_gain", share)
    swing, decay = 2.0 * np.pi / (draws.at(0.4, 0.9) * LENGTH), 1.0 / (draws.at(0.15, 0.4) * LENGTH)
    stiffness = swing**2 + decay**2
    solved = solve_ivp(
        lambda t, s: [s[1], stiffness * (1.0 - s[0]) - 2.0 * decay * s[1]], (0.0, LENGTH),
        [0.0, 0.0], t_eval=RECORD, rtol=1e-9, atol=1e-10,
    )  # fmt: skip
    np.testing.assert_allclose(found, draws.sign(0.2) * 0.2 * solved.y[0], atol=1e-4)


@EACH
def test_a_reservoir_empties_as_torricelli_says(share):
    found, draws = changed("emptying_reservoir", share)
    time = draws.at(0.5, 1.2) * LENGTH
    # The level falls with its root: dh/dt = -2 √h/time.
    level, levels = 1.0, []
    for _ in RECORD:
        levels.append(level)
        level = max(level - 2.0 * SUBSTEP / time * np.sqrt(max(level, 0.0)), 0.0)
    np.testing.assert_allclose(found, draws.side() * 0.2 * (1.0 - np.array(levels)), atol=5e-4)


@EACH
def test_a_room_warms_while_it_is_heated_and_cools_after(share):
    found, draws = changed("heated_room", share)
    off = draws.at(0.3, 0.7) * LENGTH
    rise, fall = draws.at(0.1, 0.4) * LENGTH, draws.at(0.15, 0.6) * LENGTH
    found = found * draws.side() / 0.2
    assert found.max() == pytest.approx(1.0, abs=2e-3)
    assert RECORD[np.argmax(found)] == pytest.approx(off, abs=3e-3)
    speed = np.gradient(found, SUBSTEP)
    end = 1.0 / (1.0 - np.exp(-off / rise))
    heated, cooled = off - 0.01 > RECORD, off + 0.01 < RECORD
    np.testing.assert_allclose(speed[heated][5:], ((end - found) / rise)[heated][5:], rtol=0.01)
    np.testing.assert_allclose(speed[cooled][:-5], (-found / fall)[cooled][:-5], rtol=0.01)


@EACH
def test_a_plugged_line_is_late_from_its_moment_on(share):
    made, defining, draws = drawn("plugged_line", 0.5, share)
    moment = draws.at(0.3, 0.7) * LENGTH
    assert made.output
    assert defining == {"time": pytest.approx(moment)}
    motion = MIDDLE + 0.4 * TRAVEL * np.sin(2.0 * np.pi * RECORD / TIME)
    read = through(made, motion)
    first = int(np.ceil(moment / SUBSTEP - 1e-6))
    np.testing.assert_array_equal(read[: first - 1], motion[: first - 1])
    kept, value, expected = np.exp(-SUBSTEP / (0.5 * TIME)), read[first - 1], []
    for y in motion[first:]:
        value = y + kept * (value - y)
        expected.append(value)
    slip = 2.0 * np.pi * 0.4 * TRAVEL / TIME * SUBSTEP
    np.testing.assert_allclose(read[first:], expected, atol=1.5 * slip)


@EACH
@pytest.mark.parametrize("size", [0.1, 1.0])
def test_a_blocked_valve_is_limited_from_its_moment_on(share, size):
    made, defining, draws = drawn("blocked_valve", size, share)
    moment = draws.at(0.3, 0.7) * LENGTH
    assert defining == {"time": pytest.approx(moment)}
    moves = np.resize(U, RECORD.size)
    passed = through(made, moves)
    limit = LOW + (1.0 - min(size, 0.9)) * SPAN
    before = moment - 1.5e-3 > RECORD
    np.testing.assert_array_equal(passed[before], moves[before])
    after = moment + 1.5e-3 < RECORD
    np.testing.assert_allclose(passed[after], np.minimum(moves[after], limit), rtol=1e-12)


def turn(name, share):
    """Return a wave at its places within a period, in units of its size, and the draws."""
    made, defining, draws = drawn(name, 0.1, share)
    most = min(0.8, np.log10(0.4 * UNEVEN.rate * TIME))
    frequency = 10.0 ** draws.at(-0.7, most) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    wave = through(made, np.zeros(8000)) / (0.1 * (TRAVEL if made.output else SPAN))
    return (np.arange(8000) * SUBSTEP * frequency + draws.random()) % 1.0, wave, draws


@EACH
def test_a_cam_s_follower_has_the_acceleration_of_a_sine(share):
    place, wave, draws = turn("cycloidal_cam", share)
    part = draws.at(0.15, 0.3)
    grid = np.linspace(0.0, 1.0, 100_001)
    pushed = np.where(grid < part, np.sin(2.0 * np.pi * grid / part), 0.0)
    falls = (grid >= part) & (grid < 2.0 * part)
    pushed -= np.where(falls, np.sin(2.0 * np.pi * (grid - part) / part), 0.0)
    lift = np.cumsum(np.cumsum(pushed))
    lift *= 2.0 / lift.max()
    # Sampled at 400 places and without a mean.
    np.testing.assert_allclose(wave, np.interp(place, grid, lift - lift[:-1].mean()), atol=3e-3)


@EACH
def test_a_relay_switches_between_two_exponentials(share):
    place, wave, draws = turn("relay_cycle", share)
    duty, bend = draws.at(0.3, 0.7), draws.at(0.5, 2.5)
    heated = place < duty - 0.01
    # What is left to the end of a heating far beyond, and to that of a cooling, as exponentials.
    beyond = 2.0 / (1.0 - np.exp(-bend))
    np.testing.assert_allclose(
        (beyond - 1.0 - wave)[heated], beyond * np.exp(-bend * place[heated] / duty), atol=2e-3
    )
    cooled = (place > duty + 0.01) & (place < 0.99)
    np.testing.assert_allclose(
        (beyond - 1.0 + wave)[cooled],
        beyond * np.exp(-bend * (place[cooled] - duty) / (1.0 - duty)), atol=2e-3,
    )  # fmt: skip
    assert wave.max() == pytest.approx(1.0, abs=0.1)


def test_jitter_is_noise_in_proportion_to_the_speed():
    made, draws = form("aperture_jitter", 0.01, 0.3)
    speed, hold = 7.0, round(1.0 / (UNEVEN.rate * SUBSTEP))
    ramp = speed * np.arange(20_000) * SUBSTEP
    wrong = (through(made, ramp) - ramp)[1:] / speed
    times = 0.01 * TIME * draws.standard_normal(20_000)
    expected = np.repeat(times, hold)[1:20_000]
    np.testing.assert_allclose(wrong, expected, atol=1e-12)
    still = np.full(500, 3.0)
    np.testing.assert_array_equal(through(form("aperture_jitter", 0.01, 0.3)[0], still), still)


@EACH
def test_sparks_come_as_often_as_the_voltage_says_and_die_away(share):
    made, draws = form("sparking_supply", 0.6, share)
    rate, lasting = draws.at(0.5, 3.0) / TIME, draws.at(0.05, 0.4) * TIME
    level = HIGH - 0.2 * SPAN
    passed = through(made, np.full(60_000, level)) / level
    due = np.cumsum(draws.exponential(1.0, 2000)) / (rate * 0.6)
    sparks = np.flatnonzero(np.diff(passed) < -1e-9) + 1
    seen = due[due < 59.0][:30]
    at = sparks[np.abs(sparks * SUBSTEP - seen[:, None]).argmin(axis=1)] * SUBSTEP
    assert (np.abs(at - seen) < SUBSTEP * (2.0 + np.arange(seen.size))).all()
    assert passed[sparks].min() == pytest.approx(0.4, abs=1e-9)
    for first, last in pairwise(sparks[:21]):
        t = np.arange(last - first) * SUBSTEP
        np.testing.assert_allclose(1.0 - passed[first:last], 0.6 * np.exp(-t / lasting), atol=0.015)
    low = np.full(3000, HIGH - 0.6 * SPAN)
    np.testing.assert_array_equal(through(form("sparking_supply", 0.6, share)[0], low), low)


@EACH
def test_a_memristor_remembers_the_charge_that_has_passed(share):
    made, draws = form("memristive_path", 0.4, share)
    time, change = draws.at(1.0, 5.0) * TIME, 0.4 * draws.side()
    middle = 0.5 * (LOW + HIGH)
    ends = np.repeat([middle + 0.25 * SPAN, middle, middle - 0.5 * SPAN], 3000)
    passed = (through(made, ends) / ends) ** 2
    charge, expected = 0.5, []
    for u in ends:
        expected.append(1.0 + change * (2.0 * charge - 1.0))
        charge = np.clip(charge + (u - middle) / (0.5 * SPAN) * SUBSTEP / time, 0.0, 1.0)
    np.testing.assert_allclose(passed, expected, rtol=1e-9)
    np.testing.assert_allclose(passed[3001:6000], passed[3001], rtol=1e-9)  # it keeps it


@EACH
def test_a_gear_stays_in_between_its_two_thresholds(share):
    made, draws = form("shifted_gear", 0.3, share)
    apart, mean = draws.at(0.06, 0.2) * SPAN, draws.at(0.1, 0.5) * TIME
    middle = 0.5 * (LOW + HIGH)
    levels = middle + apart * np.array([0.0, 1.5, 0.0, -1.5, 0.0])
    passed = through(made, np.repeat(levels, 3000)).reshape(5, 3000)
    gain = (passed / levels[:, None]) ** 2
    other = 1.0 + 0.3 * draws.side()
    np.testing.assert_allclose(gain[:, -1], [1.0, other, other, 1.0, 1.0], rtol=1e-9)
    changes = np.argmax(np.abs(gain[1] - 1.0) > 1e-6) * SUBSTEP
    assert changes == pytest.approx(mean * np.log(3.0), abs=2.5 * SUBSTEP)
