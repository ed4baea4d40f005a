"""Hidden backlash: each law against closed forms, published properties or solutions by events."""

from itertools import pairwise

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, through
from made_draws import SHARES, UNEVEN, drawn
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dea.plant.film import SUBSTEP
from dea.plant.hidden.trial import HiddenEffect, Trial

BOTTOM, TOP, TRAVEL, TIME = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel, UNEVEN.time
MIDDLE, REACH = 0.5 * (BOTTOM + TOP), 0.5 * TRAVEL
SPEED, QUICK = UNEVEN.path / UNEVEN.duration, TRAVEL / TIME
EACH = pytest.mark.parametrize("share", SHARES)
SIZES = pytest.mark.parametrize("size", [0.02, 0.2])
# The second swing ends within the first.
RETURN, LEFT = MIDDLE + 0.3 * TRAVEL, MIDDLE - 0.1 * TRAVEL
PLACES = (TOP, BOTTOM, RETURN, LEFT, RETURN)
STILL = ("dry_follower", "unequal_slopes", "eccentric_gears", "worn_screw")


def way(places, points):
    """Return a path through places, each piece of so many points with a speed of its own."""
    pieces = [
        np.linspace(a, b, n, endpoint=False)
        for (a, b), n in zip(pairwise(places), points, strict=True)
    ]
    return np.concatenate([*pieces, [places[-1]]])


def law_of(name, share, size=0.1):
    """Return a law of its own memory."""
    return drawn(name, size, share)[0]


def there_and_back(made, points=4000):
    """Return the output upwards, and what is read on the way up and, at the same places, down."""
    path = way((MIDDLE, BOTTOM, TOP, BOTTOM), (points,) * 3)
    read = through(made, path)
    return path[points : 2 * points], read[points : 2 * points], read[: 2 * points : -1]


def play(size, draws):
    half = 0.5 * size * TRAVEL
    return lambda y: half, lambda y: half


def unequal_slopes(size, draws):
    # The gap at the ends of the travel, and a straight line between.
    growth = draws.at(0.3, 0.8) * draws.side()
    ends = 0.5 * size * TRAVEL * np.array([1.0 - growth, 1.0 + growth])
    return (lambda y: np.interp(y, [BOTTOM, TOP], ends),) * 2


def eccentric_gears(size, draws):
    depth, turn = draws.at(0.3, 0.7), draws.at(0.6, 1.5) * TRAVEL
    first = draws.at(0.0, 1.0)  # of a turn, at the bottom

    def half(y):
        turned = np.exp(2j * np.pi * ((y - BOTTOM) / turn + first))
        return 0.5 * size * TRAVEL * (1.0 + depth * turned.imag)

    return half, half


def worn_screw(size, draws):
    place, width = BOTTOM + draws.at(0.35, 0.65) * TRAVEL, draws.at(0.15, 0.35) * TRAVEL
    new, taken = draws.at(0.1, 0.5) * size * TRAVEL, draws.share
    most = size * TRAVEL - new

    def wear(y):
        return most / np.exp((y - place) ** 2 / (2.0 * width**2))

    return lambda y: 0.5 * new + taken * wear(y), lambda y: 0.5 * new + (1.0 - taken) * wear(y)


@pytest.mark.parametrize("law", [play, unequal_slopes, eccentric_gears, worn_screw])
@EACH
@SIZES
def test_what_is_read_is_behind_by_half_the_gap_either_way(law, share, size):
    name = "dry_follower" if law is play else law.__name__
    made, defining, draws = drawn(name, size, share)
    assert made.output
    assert defining == ({"gap": pytest.approx(size * TRAVEL)} if law is play else {})
    place, up, down = there_and_back(made)
    behind, ahead = law(size, draws)
    widest = size * TRAVEL * 1.8
    # A whole gap after each turn it is pushed.
    rising, falling = place > BOTTOM + widest, place < TOP - widest
    atol = 1e-4 * TRAVEL
    np.testing.assert_allclose(up[rising], (place - behind(place))[rising], atol=atol)
    np.testing.assert_allclose(down[falling], (place + ahead(place))[falling], atol=atol)


@pytest.mark.parametrize("name", STILL)
@EACH
def test_a_dry_follower_knows_no_time(name, share):
    """It reads the same at the same turns, however fast the output goes between them."""
    slow, quick = (6000, 3000, 900, 5000, 700), (100, 800, 3000, 60, 400)
    places = (MIDDLE, *PLACES)
    one, other = (
        through(law_of(name, share), way(places, points))[np.cumsum((0, *points))]
        for points in (slow, quick)
    )
    np.testing.assert_allclose(one, other, rtol=1e-12)


@pytest.mark.parametrize("name", STILL)
@EACH
def test_a_small_swing_within_a_large_one_leaves_no_trace(name, share):
    """Return-point memory: the large branch goes on as if the small swing had not been."""
    inner = way((MIDDLE, BOTTOM, RETURN, LEFT, TOP), (500,) * 4)
    direct = way((MIDDLE, BOTTOM, TOP), (500, 900))
    within = through(law_of(name, share), inner)[1500:]
    without = through(law_of(name, share), direct)[500:]
    beyond = inner[1500:] > RETURN
    expected = np.interp(inner[1500:], direct[500:], without)
    np.testing.assert_allclose(within[beyond], expected[beyond], atol=1e-4 * TRAVEL)
    assert np.abs(within - expected)[~beyond].max() > 0.03 * TRAVEL


@EACH
@SIZES
def test_a_loop_of_play_is_a_parallelogram(share, size):
    made, gap = law_of("dry_follower", share, size), size * TRAVEL
    t = np.arange(30_001) * 1e-4
    y = MIDDLE + REACH * np.sin(2.0 * np.pi * t)
    read = through(made, y)[10_000:20_001]
    y = y[10_000:20_001]
    area = abs(np.sum(0.5 * (read[1:] + read[:-1]) * np.diff(y)))
    assert area == pytest.approx(gap * (2.0 * REACH - gap), rel=1e-5)
    assert np.ptp(read) == pytest.approx(2.0 * REACH - gap, rel=1e-9)
    # Its share in phase (Gelb and Vander Velde, table of describing functions).
    share_kept = 1.0 - gap / REACH
    in_phase = 0.5 + (np.arcsin(share_kept) + share_kept * np.sqrt(1.0 - share_kept**2)) / np.pi
    found = 2.0 * np.mean((read[1:] - MIDDLE) * (y[1:] - MIDDLE)) / REACH**2
    assert found == pytest.approx(in_phase, rel=1e-4)


T = np.arange(6000) * SUBSTEP
PERIOD = 1.5
OMEGA = 2.0 * np.pi / PERIOD
WAVE = MIDDLE + REACH * np.sin(OMEGA * T)
TRIANGLE = MIDDLE + REACH * (2.0 / np.pi) * np.arcsin(np.sin(OMEGA * T))
LAST = T[-1] - PERIOD < T


@EACH
@SIZES
def test_a_coasting_load_leaves_its_flank_and_lands_on_the_other(share, size):
    """In the course of a sine, from one flank to the other, by the moments of both."""
    made, defining, draws = drawn("coasting_load", size, share)
    gap, time = size * TRAVEL, draws.log(0.02, 0.3) * TIME
    assert defining == {"gap": pytest.approx(gap)}
    # It leaves where the flank slows down faster than drag slows the load.
    leaves = np.arctan(1.0 / (OMEGA * time)) / OMEGA
    start, speed = (
        REACH * np.sin(OMEGA * leaves) - 0.5 * gap,
        REACH * OMEGA * np.cos(OMEGA * leaves),
    )

    def coasted(t):
        return start + speed * time * (1.0 - np.exp(-(t - leaves) / time))

    def left(t):
        return REACH * np.sin(OMEGA * t) + 0.5 * gap - coasted(t)

    lands = brentq(left, leaves, leaves + 0.5 * PERIOD)

    def half_a_period(t):
        flown = np.where(t < lands, coasted(t), REACH * np.sin(OMEGA * t) + 0.5 * gap)
        return np.where(t < leaves, REACH * np.sin(OMEGA * t) - 0.5 * gap, flown)

    # The other half is the same with the other sign; it starts where the load leaves.
    turned = (T[LAST] - leaves) / (0.5 * PERIOD)
    sign, phase = np.where(np.floor(turned) % 2 == 0, 1.0, -1.0), turned % 1.0
    expected = MIDDLE + sign * half_a_period(leaves + phase * 0.5 * PERIOD)
    assert lands < leaves + 0.5 * PERIOD
    np.testing.assert_allclose(
        through(made, WAVE)[LAST], expected, atol=4.0 * REACH * OMEGA * SUBSTEP
    )


@EACH
def test_a_coasting_load_comes_to_rest_where_its_drag_stops_it(share):
    """Its output stops at once, in the middle of a gap that is too wide to be crossed."""
    made, draws = law_of("coasting_load", share, 0.25), drawn("coasting_load", 0.25, share)[2]
    time, rate = draws.log(0.02, 0.3) * TIME, 5.0
    stopped = np.minimum(BOTTOM + rate * T, BOTTOM + rate * 1.0)
    read = through(made, stopped)
    flank = stopped[-1] - 0.125 * TRAVEL
    assert read[-1] - flank == pytest.approx(rate * time, abs=1.1 * rate * SUBSTEP)


@EACH
@SIZES
def test_a_dead_zone_gives_way_as_another_integrator_says(share, size):
    made, defining, draws = drawn("dead_zone_spring", size, share)
    gap = size * TRAVEL
    time = draws.at(0.05, 0.25) * gap / QUICK
    assert defining == {"gap": pytest.approx(gap)}

    def follow(t, w):
        away = MIDDLE + REACH * np.sin(OMEGA * t) - w
        return np.sign(away) * np.maximum(np.abs(away) - 0.5 * gap, 0.0) / time

    first = MIDDLE + (draws.share - 0.5) * gap
    solved = solve_ivp(
        follow, (0.0, T[-1]), [first], max_step=0.01, rtol=1e-9, method="LSODA", dense_output=True
    )
    np.testing.assert_allclose(
        through(made, WAVE), solved.sol(T)[0], atol=1.5 * REACH * OMEGA * SUBSTEP
    )
    # Behind a ramp it is late by half the gap and by the way of the ramp in its time.
    ramp = BOTTOM + SPEED * 0.01 * T
    late = (ramp - through(drawn("dead_zone_spring", size, share)[0], ramp))[-1]
    assert late == pytest.approx(0.5 * gap + SPEED * 0.01 * time, abs=SPEED * 0.01 * SUBSTEP)


@EACH
@SIZES
def test_a_weak_spring_takes_up_the_play_at_its_speed(share, size):
    """Of a triangle: behind a flank that leaves faster it falls back, at most by the gap."""
    made, defining, draws = drawn("weak_preload", size, share)
    gap, closing, side = size * TRAVEL, draws.log(0.02, 0.2) * SPEED, draws.side()
    assert defining == {"gap": pytest.approx(gap)}
    rate = 4.0 * REACH / PERIOD
    # Upside down where the spring pulls down: the flank of the spring is then the upper one.
    off = side * (through(made, TRIANGLE) - TRIANGLE)[LAST]
    turns = (T[LAST] / PERIOD + 0.25 * side) % 1.0  # a rise along the spring ends at 0.5
    since = PERIOD * np.where(turns < 0.5, turns, turns - 0.5)
    # With the spring's way the flank leaves it; against it the flank meets it again.
    opened = max(rate - closing, 0.0)
    widest = min(gap, opened * 0.5 * PERIOD)
    away = np.where(
        turns < 0.5, np.minimum(opened * since, widest),
        np.maximum(widest - (rate + closing) * since, 0.0),
    )  # fmt: skip
    np.testing.assert_allclose(off, 0.5 * gap - away, atol=2.0 * rate * SUBSTEP)
    # At rest it comes back to its flank.
    made = drawn("weak_preload", size, share)[0]
    rests = np.concatenate([[MIDDLE - side * TRAVEL], np.full(4000, MIDDLE)])
    read = side * (through(made, rests)[1:] - MIDDLE)
    expected = np.minimum(-0.5 * gap + closing * T[:4000], 0.5 * gap)
    np.testing.assert_allclose(read, expected, atol=1.1 * closing * SUBSTEP)


def shaft(size, share):
    """Return the constants of a damped shaft, as its description says."""
    _, defining, draws = drawn("damped_shaft", size, share)
    gap = size * TRAVEL
    assert defining == {"gap": pytest.approx(gap)}
    drag = 1.0 / (draws.log(0.02, 0.15) * TIME)
    stiffness = drag * QUICK / (draws.at(0.05, 0.2) * gap)
    return 0.5 * gap, stiffness, 2.0 * draws.at(0.2, 0.8) * np.sqrt(stiffness), drag


def by_events(half, stiffness, damping, drag, first, output, speed, end):
    """Return the load's course from contact to contact: Nordin's phase plane in three pieces."""
    times, states = [], []
    state, t, at = [first, 0.0, output(0.0) - first], 0.0, 0

    def moment(t, s, side):
        return stiffness * (output(t) - s[0] - side * half) + damping * (speed(t) - s[1])

    def pressed(t, s, side):
        return [s[1], moment(t, s, side) - drag * s[1], 0.0]

    def free(t, s, _):
        turn = speed(t) - s[1] + stiffness / damping * (output(t) - s[0] - s[2])
        return [s[1], -drag * s[1], turn]

    def parted(t, s, side):
        return side * moment(t, s, side)

    def touches(t, s, _):
        return half - abs(s[2])

    parted.terminal = touches.terminal = True
    parted.direction = touches.direction = -1.0
    while t < end:
        law, event = (pressed, parted) if at else (free, touches)
        solved = solve_ivp(
            law, (t, end), state, args=(at,), events=event, rtol=1e-9, atol=1e-10, max_step=0.02,
            dense_output=True,
        )  # fmt: skip
        times.append((t, solved.t[-1]))
        states.append(solved.sol)
        t, state = solved.t[-1], solved.y[:, -1].copy()
        at = 0 if at else int(np.sign(state[2]))
        if at:
            state[2] = at * half
    return times, states


@EACH
@SIZES
def test_a_damped_shaft_moves_from_contact_to_contact_as_by_events(share, size):
    half, stiffness, damping, drag = shaft(size, share)
    end = 1.2 * PERIOD
    times, states = by_events(
        half, stiffness, damping, drag, MIDDLE + (2.0 * share - 1.0) * half * 0.999999,
        lambda t: MIDDLE + REACH * np.sin(OMEGA * t), lambda t: REACH * OMEGA * np.cos(OMEGA * t),
        end,
    )  # fmt: skip
    expected = np.full(T.size, np.nan)
    for (start, stop), state in zip(times, states, strict=True):
        here = (start <= T) & (stop > T)
        expected[here] = state(T[here])[0]
    known = np.isfinite(expected)
    assert np.count_nonzero(known) * SUBSTEP > 0.99 * end
    read = through(law_of("damped_shaft", share, size), WAVE)
    np.testing.assert_allclose(read[known], expected[known], atol=0.02 * half + 0.01)


@EACH
@SIZES
def test_a_damped_shaft_never_pulls_and_is_late_by_its_drag(share, size):
    half, stiffness, _, drag = shaft(size, share)
    read = through(law_of("damped_shaft", share, size), WAVE)
    speed = np.gradient(read, SUBSTEP)
    moment = np.gradient(speed, SUBSTEP) + drag * speed
    behind = WAVE - read
    # A moment is felt from the flank that pushes; the dead zone with a damper would also pull.
    strong = np.abs(moment) > 0.1 * np.abs(moment[500:]).max()
    strong[:500] = False
    assert np.count_nonzero(strong) > 500
    assert (np.sign(moment[strong]) == np.sign(behind[strong])).mean() > 0.995
    ramp = BOTTOM + 0.02 * SPEED * T
    late = (ramp - through(law_of("damped_shaft", share, size), ramp))[-1]
    assert late == pytest.approx(half + drag * 0.02 * SPEED / stiffness, rel=1e-3)


@SIZES
def test_steps_half_as_long_change_little_about_a_damped_shaft(size):
    read = []
    for times in (1, 2, 4):
        made = law_of("damped_shaft", 0.3, size)
        made._constants[4] *= times
        read.append(through(made, WAVE))
    coarse, fine = (np.abs(r - read[2]).max() for r in read[:2])
    assert coarse < 0.02 * size * TRAVEL
    assert fine < 0.5 * coarse


def test_a_label_tells_the_gap_in_the_unit_of_records():
    hidden = HiddenEffect("backlash", "dry_follower", 0.05, 3, 10.0)
    conditions = CONDITIONS._replace(bottom=0.001, top=0.003)
    trial = Trial(
        name="play", device="film", factors={}, excitation={"sampling_rate": 50.0, "kind": "-"},
        conditions=conditions, effects=(hidden,), strength=10.0, noise=None, seed=1,
    )  # fmt: skip
    assert trial._defining(hidden) == {"gap": pytest.approx(0.05 * 2.0)}


def test_no_two_forms_read_alike():
    """They differ among themselves by at least a tenth of what they differ from the output by."""
    from dea.plant.hidden import EFFECTS

    t = np.arange(12_000) * SUBSTEP
    waves = np.sin(2.0 * np.pi * 0.37 * t) + 0.6 * np.sin(2.0 * np.pi * 0.83 * t + 1.0)
    motion = CONDITIONS.bottom + CONDITIONS.travel * (0.5 + waves / 3.2)
    names = [kind.name for kind in EFFECTS["backlash"].forms]
    wrong = [through(built("backlash", name, 0.05)[0], motion) - motion for name in names]
    wrong = np.array([w - w.mean() for w in wrong])
    wrong /= np.sqrt((wrong**2).mean(axis=1, keepdims=True))
    for i, one in enumerate(wrong):
        for other in wrong[:i]:
            left = one - (one @ other) / (other @ other) * other
            assert np.sqrt(np.mean(left**2)) > 0.1
