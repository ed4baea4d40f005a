"""Hidden foreign effects against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import held, through
from made_draws import SHARES, UNEVEN, command, drawn, form
from scipy.integrate import solve_ivp
from scipy.signal import find_peaks, lfilter

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN = UNEVEN.low, UNEVEN.high, UNEVEN.span
BOTTOM, TRAVEL, TIME = UNEVEN.bottom, UNEVEN.travel, UNEVEN.time
U = command()
U[0] += 0.01
T = np.arange(U.size) * SUBSTEP
WITHIN = UNEVEN.duration > T
# Smooth, and beyond the range of the command at both ends.
WAVE = LOW + SPAN * (0.5 - 0.7 * np.cos(2.0 * np.pi * 0.9 * T))


def of_command(name, size, share, conditions=UNEVEN):
    """Return the law of a form that acts on the command, and its draws."""
    made, draws = form(name, size, share, conditions)
    assert not made.output
    return made, draws


def of_reading(name, size, share, conditions=UNEVEN):
    """Return the law of a form that acts on the reading, and its draws."""
    made, draws = form(name, size, share, conditions)
    assert made.output
    return made, draws


def factor(change):
    """Return the factor on a command whose square gains a share, or keeps at least 0.05."""
    return np.maximum(1.0 + change, 0.05) ** 0.5


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.4, 1.3])
def test_the_temperature_follows_the_squared_command(share, size):
    made, draws = of_command("thermal_feedback", size, share)
    change = size if share < 0.5 else -min(size, 0.9)
    kept = SUBSTEP / (draws.at(8.0, 30.0) * TIME)
    hot = 1.4 * U
    warmth = lfilter([0.0, kept], [1.0, kept - 1.0], (hot / HIGH) ** 2)
    expected = hot * factor(change * warmth ** draws.at(1.5, 3.0))
    np.testing.assert_allclose(through(made, hot), expected, rtol=1e-9)


def test_the_gain_of_a_hot_command_falls_to_a_twentieth_and_no_further():
    made = drawn("thermal_feedback", 1.3, 1.0, UNEVEN._replace(time=0.01))[0]
    passed = through(made, np.full(5000, 1.5 * HIGH))
    assert passed[-1] / (1.5 * HIGH) == pytest.approx(np.sqrt(0.05))


@pytest.mark.parametrize("size", [0.03, 0.2, 0.6])
def test_a_reading_is_sent_when_it_is_wrong_by_more_than_a_threshold(size):
    made, _ = of_reading("send_on_delta", size, 0.3)
    expected, sent = np.full(U.size, U[0]), 0
    while True:
        wrong = np.flatnonzero(np.abs(U[sent:] - U[sent]) > size * TRAVEL)
        if wrong.size == 0:
            break
        sent += wrong[0]
        expected[sent:] = U[sent]
    np.testing.assert_array_equal(through(made, U), expected)
    just = np.array([0.0, size * TRAVEL])
    np.testing.assert_array_equal(through(drawn("send_on_delta", size, 0.3)[0], just), 0.0)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 1.4])
def test_the_contact_is_bad_between_every_other_two_moments(share, size):
    made, draws = of_command("telegraph_contact", size, share)
    moments = np.cumsum(draws.exponential(draws.at(1.0, 6.0) * TIME, 200))
    expected = U.copy()
    for start, end in zip(moments[::2], moments[1::2], strict=True):
        expected[(start < T) & (end > T)] *= max(1.0 - size, 0.0)
    clear = np.abs(T[:, None] - moments).min(axis=1) > SUBSTEP
    np.testing.assert_allclose(through(made, U)[clear & WITHIN], expected[clear & WITHIN])
    assert np.abs(expected - U)[WITHIN].max() > 0.0


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.02, 0.73])
def test_a_command_is_late_in_proportion_to_itself(share, size):
    made, draws = of_command("input_dependent_delay", size, share)
    late = size * TIME * draws.at(0.9, 1.1) * np.clip((WAVE - LOW) / SPAN, 0.0, 1.0) / SUBSTEP
    came = np.arange(T.size) - np.floor(late + 1e-12).astype(int)
    np.testing.assert_array_equal(through(made, WAVE), WAVE[np.maximum(came, 0)])


@pytest.mark.parametrize("name", ["held_readings", "lost_commands"])
@pytest.mark.parametrize("share", SHARES)
def test_what_came_last_is_held_over_a_gap(name, share):
    made, draws = form(name, 0.4, share)
    assert made.output is (name == "held_readings")
    lengths = draws.exponential([draws.at(2.0, 8.0) * TIME, 0.4 * TIME], (50, 2))
    moments = np.cumsum(lengths.ravel())
    expected = WAVE.copy()
    for start, end in zip(moments[::2], moments[1::2], strict=True):
        gap = (start < T) & (end > T)
        expected[gap] = np.interp(start, T, WAVE)
    clear = np.abs(T[:, None] - moments).min(axis=1) > SUBSTEP
    known = clear & WITHIN
    assert np.count_nonzero(np.abs(expected - WAVE)[known] > 0.05 * SPAN) > 100
    fastest = np.abs(np.diff(WAVE)).max()
    np.testing.assert_allclose(through(made, WAVE)[known], expected[known], atol=2.0 * fastest)


def test_gaps_go_on_to_the_end_of_the_record():
    minute = UNEVEN._replace(duration=60.0)
    ramp = np.arange(60_000) * SUBSTEP
    held_still = np.diff(through(drawn("held_readings", 0.4, 1.0, minute)[0], ramp)) == 0.0
    assert held_still[-15_000:].any()


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 0.9])
def test_the_supply_modulates_with_two_sines(share, size):
    made, draws = of_command("modulated_gain", size, share)
    angle = 2.0 * np.pi * 10.0 ** draws.at(-0.5, 0.7) / TIME * T + draws.at(0.0, 6.28)
    expected = U * factor(size * (np.sin(angle) + draws.at(0.0, 0.4) * np.sin(2.0 * angle)))
    np.testing.assert_allclose(through(made, U), expected, rtol=1e-6)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 1.4])
def test_the_gain_is_that_of_the_last_peak(share, size):
    made, _ = of_command("peak_memory", size, share)
    change = size if share < 0.5 else -min(size, 0.9)
    # A peak is one as soon as the command falls; before the first, the command's start is.
    for signal in (U, U[::-1], WAVE + 0.4 * np.sin(23.0 * T)):
        fallen = find_peaks(signal, plateau_size=1)[1]["right_edges"] + 1
        assert fallen.size > 5
        since = np.searchsorted(fallen, np.arange(signal.size), side="right")
        peaks = np.append(signal[0], signal[fallen - 1])[since]
        made = drawn("peak_memory", size, share)[0]
        expected = signal * factor(change * (peaks - LOW) / SPAN)
        np.testing.assert_allclose(through(made, signal), expected, rtol=1e-9)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.05, 0.4])
def test_a_command_is_rounded_to_the_nearest_level(share, size):
    made, _ = of_command("coarse_commands", size, share)
    levels = LOW + size * SPAN * (np.arange(-30, 60) + share)
    nearest = levels[np.abs(WAVE[:, None] - levels).argmin(axis=1)]
    np.testing.assert_allclose(through(made, WAVE), nearest, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_supply_s_noise_is_a_table_with_straight_pieces_that_repeats(share):
    made, draws = of_command("unsteady_supply", 0.3, share)
    kept = np.exp(-0.02 / draws.at(0.2, 1.5))
    raw = draws.standard_normal(2 + int(1.2 * UNEVEN.duration / (0.02 * TIME)))
    raw[1:] *= np.sqrt(1.0 - kept**2)
    table = lfilter([1.0], [1.0, -kept], raw)
    places = np.arange(2 * table.size) * 0.02 * TIME
    expected = U + 0.3 * SPAN * np.interp(T, places, np.tile(table, 2))
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    assert T[-1] > (table.size + 5) * 0.02 * TIME


@pytest.mark.parametrize("share", SHARES)
def test_a_spike_lasts_a_hundredth_of_a_band_period(share):
    made, draws = of_reading("outliers", 0.3, share)
    length = 0.01 * TIME
    every = draws.at(15.0, 40.0) * length
    starts = np.cumsum(draws.exponential(every, 2 + int(2.0 * UNEVEN.duration / every)))
    heights = draws.standard_t(3.0, starts.size)
    expected, free = U.copy(), 0.0
    for start, height in zip(starts, heights, strict=True):
        # While one lasts, the next waits.
        spike = (max(start, free) <= T) & (start + length >= T)
        expected[spike] += 0.3 * TRAVEL * height
        free = max(free, start + length)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    assert np.count_nonzero(expected - U) > 80


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.1, 0.5])
def test_the_unmeasured_input_is_lorenz_s(share, size):
    """Compared while two solutions of a chaotic system stay close to each other."""
    slow = UNEVEN._replace(time=7.0)
    made, draws = of_command("unmeasured_input", size, share, slow)
    pace = draws.at(0.3, 1.5) / slow.time

    def flow(t, s):
        x, y, z = s
        return [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z]

    start = np.array([1.0, 1.0, 20.0]) + draws.at(0.0, 5.0)
    seconds = np.arange(round(1.5 / pace / SUBSTEP)) * SUBSTEP
    passed = through(made, np.ones(seconds.size))
    solved = solve_ivp(flow, (0.0, 1.5), start, rtol=1e-9, atol=1e-9, dense_output=True)
    x = solved.sol(seconds * pace)[0]
    np.testing.assert_allclose(passed**2, factor(size * x / 8.0) ** 2, atol=0.05 * size)
    assert np.ptp(x) > 5.0


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 0.9])
def test_the_gain_follows_the_direction_with_a_lag(share, size):
    made, draws = of_command("direction_gain", size, share)
    for signal in (U, U[::-1], WAVE):
        turned = np.sign(np.diff(signal, prepend=signal[0]))
        moved = np.maximum.accumulate(np.where(turned != 0.0, np.arange(signal.size), 0))
        kept = SUBSTEP / (draws.at(0.05, 0.3) * TIME)
        smooth = lfilter([kept], [1.0, kept - 1.0], turned[moved])
        made = drawn("direction_gain", size, share)[0]
        expected = signal * factor(size * draws.side() * smooth)
        np.testing.assert_allclose(through(made, signal), expected, rtol=1e-9)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.03, 1.37])
def test_the_clock_is_later_and_later_and_then_stays_late(share, size):
    made, draws = of_command("drifting_clock", size, share)
    over = np.minimum(T / UNEVEN.duration, 1.0) ** draws.at(0.7, 2.0)
    came = np.arange(T.size) - np.floor(size * TIME * over / SUBSTEP + 1e-12).astype(int)
    passed = through(made, WAVE)
    exact = passed == WAVE[np.maximum(came, 0)]
    assert np.count_nonzero(~exact) <= 2  # where a delay is a whole number of sub-steps
    assert exact[-1]


@pytest.mark.parametrize(("time", "hold"), [(0.35, 7), (0.01, 1)])
def test_speckle_is_held_for_a_while_and_its_table_repeats(time, hold):
    made, draws = of_reading("speckle", 0.3, 0.3, UNEVEN._replace(time=time))
    noise = np.tile(np.repeat(draws.standard_normal(20_000), hold), 2)[:150_000]
    y = BOTTOM + np.linspace(-1.0, TRAVEL, noise.size)
    expected = y + 0.3 * (y - BOTTOM) * noise
    np.testing.assert_allclose(through(made, y)[: noise.size], expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_buckled_strip_s_force_is_a_sine_in_a_bell(share):
    made, defining, draws = drawn("bistable_snap", 0.3, share)
    assert not defining
    middle = BOTTOM + draws.at(0.3, 0.6) * TRAVEL
    for y in np.linspace(BOTTOM, UNEVEN.top, 23):
        width = 2.0 * np.pi * 0.3 * TRAVEL / draws.at(2.0, 4.0)
        place = (y - middle) / width
        bell = np.imag(np.exp(2j * np.pi * place - place**2))
        force = -0.3 * UNEVEN.stiffness * TRAVEL * bell
        assert held(made, y, SUBSTEP)[0] == pytest.approx(force, abs=1e-9)
