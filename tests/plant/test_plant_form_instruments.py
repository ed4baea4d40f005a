"""Hidden laws of gauges, stages and circuits, each against another statement."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn, form
from scipy.integrate import quad, solve_ivp
from scipy.signal import cont2discrete, lfilter, lfiltic

from dea.plant.film import SUBSTEP

SPAN, TIME = UNEVEN.span, UNEVEN.time
BOTTOM, TOP, TRAVEL = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel
EACH = pytest.mark.parametrize("share", SHARES)
Y = np.linspace(BOTTOM, TOP, 2001)
U = command()
T = np.arange(U.size) * SUBSTEP
MOTION = BOTTOM + TRAVEL * (U - UNEVEN.low) / SPAN


def limited(name, share, size=0.5):
    """Return the law of a reading that is limited, its draws and its limit."""
    made, defining, draws = drawn(name, size, share)
    limit = TOP - size * TRAVEL
    assert made.output
    assert defining == {"limit": pytest.approx(limit)}
    return made, draws, limit


@EACH
def test_stages_limit_one_after_the_other(share):
    made, draws, limit = limited("limiting_stages", share)
    ratio, rise = draws.at(2.0, 3.5), draws.at(0.015, 0.04) * TRAVEL
    read = through(made, Y)
    # Each stage amplifies what the one before has left, up to the same output.
    knee = limit - 2.0 * rise
    over = np.maximum(Y - knee, 0.0)
    first = np.minimum(over / ratio, rise)
    second = np.clip((over - ratio * rise) / ratio**2, 0.0, rise)
    np.testing.assert_allclose(read, np.minimum(Y, knee) + first + second, atol=2e-3 * TRAVEL)
    far = np.array([limit + 1.5 * TRAVEL])
    assert through(limited("limiting_stages", share)[0], far)[0] == pytest.approx(limit)


@EACH
def test_a_ripple_s_mean_is_that_of_its_cut_wave(share):
    made, draws, limit = limited("rippled_limit", share)
    ripple = draws.at(0.04, 0.15) * TRAVEL
    wave = ripple * np.sin(2.0 * np.pi * (np.arange(5000) + 0.5) / 5000)
    expected = [np.minimum(y + wave, limit).mean() for y in Y[::20]]
    np.testing.assert_allclose(through(made, Y)[::20], expected, atol=1e-3 * ripple)


@EACH
@pytest.mark.parametrize("size", [0.1, 1.0])
def test_a_hot_wire_s_squared_squared_voltage_is_straight(share, size):
    made, draws = form("hot_wire", size, share)
    read = through(made, Y)
    assert read[[0, -1]] == pytest.approx([BOTTOM, TOP], rel=1e-4)
    b = draws.at(0.8, 3.0)
    flow = 1.0 + 20.0 * size * (Y - BOTTOM) / TRAVEL
    if share < 0.5:
        flow = flow[::-1]
    ends = np.sqrt(1.0 + b * np.sqrt(flow[[0, -1]]))
    voltage = np.interp(read, [BOTTOM, TOP], ends)
    np.testing.assert_allclose(((voltage**2 - 1.0) / b) ** 2, flow, rtol=2e-3)


@EACH
@pytest.mark.parametrize("size", [0.1, 1.5])
def test_a_tank_s_volume_is_the_integral_of_its_width(share, size):
    made, draws = form("tank_gauge", size, share)
    read = through(made, Y)
    covered = 0.6 * size
    apart = 0.02 + draws.at(0.0, 0.2) * (0.96 - covered)
    lowest = apart if share < 0.5 else 1.0 - covered - apart

    def volume(level):
        return quad(lambda h: np.sqrt(h * (1.0 - h)), lowest, lowest + covered * level)[0]

    levels = np.linspace(0.0, 1.0, 21)
    expected = BOTTOM + TRAVEL * np.array([volume(x) for x in levels]) / volume(1.0)
    np.testing.assert_allclose(read[::100], expected, atol=2e-3 * TRAVEL)


@EACH
@pytest.mark.parametrize("size", [0.05, 0.6])
def test_a_divider_with_strays_passes_a_share_at_once(share, size):
    made, defining, draws = drawn("stray_capacity", size, share)
    mean, direct = size * TIME, draws.at(0.1, 0.35)
    assert defining == {"lag": pytest.approx(mean)}
    time = mean / (1.0 - direct)
    b, a, _ = cont2discrete(([direct * time, 1.0], [time, 1.0]), SUBSTEP)
    # A value is taken at the beginning of a sub-step, and read at its end, what comes at once now.
    lag = cont2discrete(([1.0], [time, 1.0]), SUBSTEP)
    ahead, behind = lag[0].ravel()[1:], lag[1]
    start = lfiltic(ahead, behind, U[:1], U[:1])
    slow = lfilter(ahead, behind, U, zi=start)[0]
    np.testing.assert_allclose(through(made, U), direct * U + (1.0 - direct) * slow, atol=1e-9)
    assert a[1] == pytest.approx(behind[1])
    assert b.sum() == pytest.approx(a.sum())


@EACH
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_a_composite_warms_as_another_integrator_says(share, size):
    made, draws = form("warming_composite", size, share)
    growth, warming = draws.at(0.5, 2.0), draws.at(2.0, 8.0) * TIME
    lag, scale = size * TIME, SPAN * size / (1.0 + 2.0 * size)

    def charge(t, s):
        error = np.interp(t, T, U) - s[0]
        resistance = 1.0 + growth * (1.0 - 1.0 / (1.0 + s[1]))
        return [error / (lag * resistance), (error**2 / scale**2 / resistance - s[1]) / warming]

    solved = solve_ivp(charge, (0.0, T[-1]), [U[0], 0.0], max_step=5e-3, rtol=1e-8, t_eval=T)
    np.testing.assert_allclose(through(made, U), solved.y[0], atol=0.03 * SPAN)
    assert solved.y[1].max() > 0.05


@EACH
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_still_air_cools_by_a_power_of_the_difference(share, size):
    made, draws = form("still_air", size, share)
    scale = draws.at(0.05, 0.3) * TRAVEL
    power = draws.side(1.25, 4.0 / 3.0)
    # By parts of a sub-step, with the explicit rule: e' = -(e/scale)^p scale/time.
    error, left = 0.8 * TRAVEL, []
    for _ in range(1500):
        for _ in range(20):
            error -= SUBSTEP / 20 * scale / (size * TIME) * (error / scale) ** power
        left.append(error)
    for side in (-1.0, 1.0):
        made = form("still_air", size, share)[0]
        place = 0.5 * (BOTTOM + TOP)
        read = through(made, np.repeat([place - side * 0.8 * TRAVEL, place], [1, 1500]))[1:]
        np.testing.assert_allclose(side * (place - read), left, atol=2e-3 * TRAVEL)


@pytest.mark.parametrize("size", [0.01, 0.4])
def test_a_voltmeter_shows_the_mean_of_the_window_before(size):
    made, defining, _ = drawn("digital_voltmeter", size, 0.3)
    window = round(size * TIME / SUBSTEP) + 1
    assert defining == {"lag": pytest.approx((window - 1) * SUBSTEP)}
    read = through(made, MOTION)
    whole = MOTION.size // window
    means = MOTION[: whole * window].reshape(whole, window).mean(axis=1)
    shown = np.repeat(means, window)
    later = read[window - 1 :]
    np.testing.assert_allclose(later, shown[: later.size], atol=1e-9)
    assert (read[: window - 1] == MOTION[0]).all()
    # Behind a ramp it is late by its lag on average.
    ramp = 3.0 * T
    late = ramp - through(drawn("digital_voltmeter", size, 0.3)[0], ramp)
    inside = slice(3 * window, 3 * window + (T.size // window - 4) * window)
    assert late[inside].mean() == pytest.approx(3.0 * defining["lag"], rel=1e-6)
