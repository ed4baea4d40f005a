"""Hidden laws of pumps, limiters, queues and leaking layers, each against another statement."""

import numpy as np
import pytest
from made_conditions import TIME as T
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn, form
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN, TIME = UNEVEN.low, UNEVEN.high, UNEVEN.span, UNEVEN.time
EACH = pytest.mark.parametrize("share", SHARES)
SIDES = pytest.mark.parametrize("side", [-1.0, 1.0])
U = np.linspace(LOW, HIGH, 2001)
WAVE = command()


@EACH
@pytest.mark.parametrize("size", [0.1, 0.4])
def test_a_pump_gives_the_flow_at_which_its_head_is_that_of_the_pipe(share, size):
    made, defining, draws = drawn("static_head", size, share)
    threshold, droop = LOW + size * SPAN, draws.at(0.1, 0.5)
    assert defining == {"threshold": pytest.approx(threshold)}

    def flow(u):
        if u <= threshold:
            return 0.0
        return brentq(lambda q: u * u - droop * u * q - q * q - threshold**2, 0.0, u)

    expected = np.array([flow(u) for u in U]) * HIGH / flow(HIGH)
    passed = through(made, U)
    away = np.abs(U - threshold) > 2e-3
    np.testing.assert_allclose(passed[away], expected[away], atol=1e-4 * HIGH)
    over = U[away & (threshold < U)]
    assert (np.diff(np.interp(over, U, passed), 2) < 1e-9).all()  # ever less


@EACH
def test_a_paste_yields_less_while_it_flows_and_gels_at_rest(share):
    made, draws = form("gelling_paste", 0.4, share)
    threshold = LOW + 0.4 * SPAN
    least, rest = threshold * draws.at(0.5, 0.8), TIME * draws.at(1.0, 4.0)
    gain = HIGH / (HIGH - least)

    def gel(t, s, u):
        flow = gain * max(u - least - (threshold - least) * s[0], 0.0)
        return [(1.0 - s[0]) / rest - 10.0 / rest * flow / HIGH * s[0]]

    passed = through(made, np.repeat([LOW, HIGH, LOW, HIGH], [500, 4000, 1000, 500]))
    state, expected = [1.0], []
    for u, samples in ((LOW, 500), (HIGH, 4000), (LOW, 1000), (HIGH, 500)):
        t = np.arange(samples + 1) * SUBSTEP
        solved = solve_ivp(gel, (0.0, t[-1]), state, t_eval=t, args=(u,), rtol=1e-9, atol=1e-12)
        gelled = solved.y[0]
        expected.append(gain * np.maximum(u - least - (threshold - least) * gelled[:-1], 0.0))
        state = [gelled[-1]]
    np.testing.assert_allclose(passed, np.concatenate(expected), atol=5e-3 * HIGH)
    assert passed[:500].max() == 0.0
    assert passed[500] == pytest.approx(gain * (HIGH - threshold), rel=1e-9)


@pytest.mark.parametrize("size", [0.1, 0.44])
def test_a_bridge_passes_the_fundamental_of_a_wave_whose_peaks_are_cut(size):
    knee = HIGH - size * SPAN
    passed = through(form("overmodulated_bridge", size, 0.3)[0], U)
    angle = (np.arange(20_000) + 0.5) * 0.5 * np.pi / 20_000
    for u in np.linspace(LOW, HIGH, 9):
        cut = np.minimum(u * np.sin(angle), knee)
        fundamental = 2.0 * np.mean(cut * np.sin(angle))
        assert np.interp(u, U, passed) == pytest.approx(fundamental, rel=2e-4)
    far = through(form("overmodulated_bridge", size, 0.3)[0], [2.0 * HIGH])[0]
    assert passed[-1] < far < 4.0 / np.pi * knee


@EACH
def test_a_limiter_falls_and_returns_with_its_two_times(share):
    made, defining, draws = drawn("programme_limiter", 0.4, share)
    limit = HIGH - 0.4 * SPAN
    assert defining == {"limit": pytest.approx(limit)}
    attack, release = draws.at(0.01, 0.05) * TIME, draws.at(0.1, 0.6) * TIME
    passed = through(made, np.repeat([HIGH, 0.5 * LOW], [500, 1500]))
    t = np.arange(1, 501) * SUBSTEP
    wanted = limit / HIGH
    gain = wanted + (1.0 - wanted) * np.exp(-t / attack)
    np.testing.assert_allclose(passed[:500], HIGH * gain, rtol=1e-9)
    t = np.arange(1, 1501) * SUBSTEP
    left = (1.0 - gain[-1]) * np.exp(-t / release)
    np.testing.assert_allclose(passed[500:], 0.5 * LOW * (1.0 - left), rtol=1e-9)
    below = np.full(300, 0.9 * limit)
    np.testing.assert_array_equal(through(drawn("programme_limiter", 0.4, share)[0], below), below)


def step(name, share, size=0.8, distance=0.9 * SPAN, side=1.0, samples=3000):
    """Return the way after each sub-step of a step, the draws and the rate."""
    made, defining, draws = drawn(name, size, share)
    rate = SPAN / (size * TIME)
    assert defining == {"rate": pytest.approx(rate)}
    passed = through(made, np.repeat([2.0, 2.0 + side * distance], [20, samples]))
    np.testing.assert_array_equal(passed[:20], 2.0)
    return side * (passed[20:] - 2.0), draws, rate


@EACH
@SIDES
def test_a_carrier_s_way_is_lambert_s_function_of_time(share, side):
    distance = 0.9 * SPAN
    way, draws, rate = step("saturable_carrier", share, side=side)
    half = draws.at(0.01, 0.04) * SPAN
    # By the integrated law of Michaelis and Menten: e0 - e + half ln(e0/e) = rate t.
    error = distance - way
    inside = error > 1e-6 * SPAN
    passed = (distance - error + half * np.log(distance / np.maximum(error, 1e-12))) / rate
    t = np.arange(1, 3001) * SUBSTEP
    np.testing.assert_allclose(passed[inside], t[inside], atol=0.02 * TIME)
    assert (np.diff(way) >= 0.0).all()
    # Behind a ramp of half its rate the error is the scale.
    ramp = 2.0 + side * 0.5 * rate * T[:800]
    late = side * (ramp - through(drawn("saturable_carrier", 0.8, share)[0], ramp))[-1]
    assert late == pytest.approx(half, rel=1e-3)


@EACH
@SIDES
def test_a_lift_slows_down_before_its_floor(share, side):
    distance = 0.9 * SPAN
    way, draws, rate = step("two_speed_lift", share, side=side)
    slow, zone = rate / draws.at(3.0, 8.0), draws.at(0.02, 0.08) * SPAN
    fast = (distance - zone) / rate
    t = np.arange(1, 3001) * SUBSTEP
    expected = np.interp(t, [0.0, fast, fast + zone / slow], [0.0, distance - zone, distance])
    np.testing.assert_allclose(way, expected, atol=1.01 * rate * SUBSTEP)
    assert way[-1] == pytest.approx(distance, rel=1e-12)


@EACH
def test_a_turbulent_pipe_s_streams_arrive_from_the_axis_first(share):
    size = 0.5
    made, defining, draws = drawn("turbulent_pipe", size, share)
    power = 1.0 / draws.at(6.0, 9.0)
    mean = size * TIME
    assert defining == {"delay": pytest.approx(mean, abs=SUBSTEP)}
    # The mean over the flow of one over the speed is the area over the flow.
    flow = quad(lambda r: 2.0 * r * (1.0 - r) ** power, 0.0, 1.0)[0]
    passed = through(made, np.repeat([0.0, 1.0], [1, 1000]))[1:]

    def arrived(t):
        # What is quicker than t, in units of the time of the axis.
        edge = 1.0 - min(flow * mean / t, 1.0) ** (1.0 / power)
        return quad(lambda r: 2.0 * r * (1.0 - r) ** power, 0.0, edge)[0] / flow

    for share_of_mean in (0.9, 1.0, 1.1, 1.2):
        t = share_of_mean * mean
        assert passed[round(t / SUBSTEP)] == pytest.approx(arrived(t), abs=1.5 / 24.0)
    assert passed[round(0.98 * flow * mean / SUBSTEP)] == 0.0


@EACH
@pytest.mark.parametrize("size", [0.05, 0.5])
def test_packets_leave_in_order_each_when_its_server_is_free(share, size):
    made, draws = form("queued_packets", size, share)
    mean = size * TIME / SUBSTEP
    period = max(round(mean / draws.at(5.0, 10.0)), 1)
    samples = 2000 * period
    passed = through(made, np.arange(float(samples)))
    # What is held is the number of the sub-step at which it was taken.
    held = passed[round(3 * mean) :]
    assert (np.diff(held) >= 0.0).all()
    assert (held % period == 0.0).all()
    age = np.arange(samples)[round(3 * mean) :] - held
    assert age.mean() * SUBSTEP == pytest.approx(size * TIME, rel=0.03, abs=1.5 * SUBSTEP)
    # Departures of a queue with one server: a sample leaves when it has been served, in turn.
    services = draws.exponential(period * draws.at(0.5, 0.8), 2000)
    free, left = 0.0, []
    for k in range(samples // period):
        free = max(free, k * period) + services[k]
        left.append(free)
    leaves = np.array(left)
    seen = np.searchsorted(passed, period * np.arange(leaves.size))
    inside = slice(2, leaves.size - round(3 * mean / period) - 2)
    late = seen[inside] - leaves[inside]
    assert np.ptp(late) <= 1.01


@EACH
def test_ions_that_meet_in_pairs_are_gone_as_one_over_time(share):
    made, draws = form("recombining_ions", 0.4, share)
    time = TIME * draws.log(1.0, 8.0)
    whole = 0.4 * HIGH
    passed = through(made, np.repeat([HIGH, 0.3 * HIGH], [3000, 3000]))

    def ions(t, n, u):
        return max(u - whole * n[0], 0.0) / HIGH / time - n[0] ** 2 / time

    n, expected = 0.0, []
    for u in (HIGH, 0.3 * HIGH):
        t = np.arange(3001) * SUBSTEP
        solved = solve_ivp(
            lambda t, n, u: [ions(t, n, u)], (0.0, 3.0), [n], t_eval=t, args=(u,), rtol=1e-9,
            atol=1e-11, max_step=0.02,
        )  # fmt: skip
        expected.append(np.maximum(u - whole * solved.y[0][:-1], 0.0))
        n = solved.y[0][-1]
    np.testing.assert_allclose(passed, np.concatenate(expected), atol=2e-3 * HIGH)
    # Without a field the number left is 1/(1/n + t/time).
    law = form("recombining_ions", 0.4, share)[0]
    through(law, np.repeat([HIGH, 0.0], [3000, 2000]))
    before = (HIGH - passed[2999]) / whole
    assert law._memory[0] == pytest.approx(1.0 / (1.0 / before + 2.0 / time), rel=2e-3)


@EACH
def test_a_layer_takes_up_what_diffuses_into_it(share):
    made, draws = form("intercalating_ions", 0.4, share)
    slowest = TIME * draws.log(2.0, 20.0)
    passed = through(made, np.ones(6000))
    # By differences in a layer whose back is closed; its own time is (2/π)² thicknesses².
    cells = 200
    diffusion = 4.0 / np.pi**2 / slowest
    matrix = -2.0 * np.eye(cells) + np.eye(cells, k=1) + np.eye(cells, k=-1)
    matrix[0, 0], matrix[-1, -1] = -3.0, -1.0
    values, vectors = np.linalg.eigh(matrix * diffusion * cells**2)
    parts = vectors.sum(axis=0) ** 2 / cells
    t = np.arange(1, 6001) * SUBSTEP
    for k in (60, 300, 1000, 5999):
        taken = 1.0 - parts @ np.exp(values * t[k])
        # Twelve of infinitely many times: what the others take up comes at once.
        assert 1.0 - passed[k] == pytest.approx(0.4 * taken, abs=0.4 * 0.018)
    early = 1.0 - passed[40:200]
    order = np.polyfit(np.log(t[40:200]), np.log(early), 1)[0]
    assert 0.4 < order < 0.65
