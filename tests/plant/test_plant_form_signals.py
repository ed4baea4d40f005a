"""Hidden laws of command and reading with a memory of their own, against another statement."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import lfilter
from scipy.stats import gamma

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN = UNEVEN.low, UNEVEN.high, UNEVEN.span
BOTTOM, TOP, TRAVEL, TIME = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel, UNEVEN.time
U = command()
T = np.arange(U.size) * SUBSTEP
WAVE = 2.3 + 1.6 * np.sin(2.0 * np.pi * 1.1 * T)  # of the command, without steps
SWING = BOTTOM + TRAVEL * (0.5 - 0.5 * np.cos(2.0 * np.pi * 0.8 * T))


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 0.44])
def test_the_lamp_strikes_at_its_threshold_and_burns_until_its_voltage_is_gone(share, size):
    made, defining, draws = drawn("glow_lamp", size, share)
    assert not defining
    strike = LOW + size * SPAN
    burning = draws.at(0.5, 0.85) * strike
    wave = 0.5 * HIGH * (1.0 - np.cos(2.0 * np.pi * 1.3 * T))
    # In each period it is lit from the first value above the one to the last above the other.
    expected, period = np.zeros(T.size), round(1.0 / 1.3 / SUBSTEP)
    starts = np.rint(np.arange(0.0, T[-1], 1.0 / 1.3) / SUBSTEP).astype(int)
    for start in starts:
        piece = slice(start, min(start + period, T.size))
        lit = np.flatnonzero(wave[piece] > strike)
        if lit.size:
            after = np.flatnonzero(
                (wave[piece] <= burning) & (np.arange(T.size)[piece] > start + lit[0])
            )
            last = after[0] if after.size else T[piece].size
            expected[start + lit[0] : start + last] = 1.0
    expected *= HIGH * (wave - burning) / (HIGH - burning)
    np.testing.assert_allclose(through(made, wave), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_a_saturated_stage_is_late_by_moll_s_storage_time(share):
    made, defining, draws = drawn("stored_charge", 0.3, share)
    limit, time = HIGH - 0.3 * SPAN, draws.at(0.05, 0.4) * TIME
    assert defining == {"limit": pytest.approx(limit)}
    over, under = 0.7 * (HIGH - limit), 0.4 * limit
    for seconds in (0.3 * time, 8.0 * time):
        steps = round(seconds / SUBSTEP)
        levels = [limit - under, limit + over, limit - under]
        made = drawn("stored_charge", 0.3, share)[0]
        passed = through(made, np.repeat(levels, [100, steps, 1000]))
        np.testing.assert_array_equal(passed[:100], limit - under)
        np.testing.assert_array_equal(passed[100 : 100 + steps], limit)
        late = np.count_nonzero(passed[100 + steps :] == limit) * SUBSTEP
        assert passed[-1] == limit - under
        charged = over * -np.expm1(-seconds / time)
        assert late == pytest.approx(time * np.log1p(charged / under), abs=0.03 * time + SUBSTEP)


@pytest.mark.parametrize("share", SHARES)
def test_a_grid_blocks_as_another_integrator_says(share):
    made, defining, draws = drawn("blocking_grid", 0.4, share)
    assert made.output
    limit, decay = TOP - 0.4 * TRAVEL, draws.at(0.5, 3.0) * TIME
    assert defining == {"limit": pytest.approx(limit)}
    charge = draws.at(0.15, 0.5) / decay

    def bias(t, b):
        over = np.interp(t, T, SWING) - b - limit
        return charge * np.maximum(over, 0.0) - b / decay

    solved = solve_ivp(bias, (0.0, T[-1]), [0.0], max_step=0.005, rtol=1e-8, dense_output=True)
    expected = np.minimum(SWING - solved.sol(T)[0], limit)
    np.testing.assert_allclose(through(made, SWING), expected, atol=2e-3 * TRAVEL)
    # After a long overload the bias is a share of it, and then decays.
    made = drawn("blocking_grid", 0.4, share)[0]
    steps = round(30.0 * decay / SUBSTEP)
    read = through(made, np.repeat([TOP, BOTTOM], [steps, 2000]))
    ratio = draws.at(0.15, 0.5)
    lacking = 0.4 * TRAVEL * ratio / (1.0 + ratio)
    assert BOTTOM - read[steps] == pytest.approx(lacking, rel=0.01)
    later = steps + round(decay / SUBSTEP)
    assert BOTTOM - read[later] == pytest.approx(lacking * np.exp(-1.0), rel=0.02)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 1.4])
def test_a_wiper_divides_its_track_in_proportion_to_the_resistance(share, size):
    made, defining, draws = drawn("uneven_track", size, share)
    assert made.output
    assert not defining
    pieces = np.exp(size * draws.standard_normal(draws.integers(30, 81)))
    y = np.linspace(BOTTOM, TOP, 700)
    each = np.repeat(pieces, 2000) / 2000.0
    ends = BOTTOM + TRAVEL * (np.arange(each.size) + 0.5) / each.size
    below = np.array([each[ends < place].sum() for place in y])
    read = through(made, y)
    np.testing.assert_allclose(read, BOTTOM + TRAVEL * below / each.sum(), atol=5e-3 * TRAVEL)
    assert (np.diff(read) > 0.0).all()
    outside = np.array([BOTTOM - TRAVEL, TOP + 2.0 * TRAVEL])
    np.testing.assert_allclose(through(made, outside), outside, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [1.0, 2.0])
def test_the_amplifier_slews_and_rings_as_another_integrator_says(share, size):
    made, defining, draws = drawn("ringing_amplifier", size, share)
    rate = SPAN / (size * TIME)
    assert defining == {"rate": pytest.approx(rate)}
    angular = 2.0 * np.pi / (draws.at(0.1, 0.3) * size * TIME)
    damping = draws.at(0.3, 0.6)

    def follow(t, s):
        # ω² (u - y) = y" + 2 d ω y' as long as the first stage does not slew.
        error = np.clip(0.5 * angular / damping * (HIGH - s[1]), -rate, rate)
        return [error, 2.0 * damping * angular * (s[0] - s[1])]

    solved = solve_ivp(follow, (0.0, 2.0), [LOW, LOW], max_step=0.002, dense_output=True)
    passed = through(made, np.repeat([LOW, HIGH], [1, 2000]))[1:]
    expected = solved.sol((np.arange(2000) + 1.0) * SUBSTEP)[1]
    np.testing.assert_allclose(passed, expected, atol=0.03 * SPAN)
    assert passed.max() > HIGH + 1e-3 * SPAN
    # Far below its rate it is the linear lag, whose overshoot its damping states.
    made = drawn("ringing_amplifier", size, share)[0]
    small = through(made, np.repeat([0.0, 1e-3], [1, 2000])) / 1e-3
    over = np.exp(-np.pi * damping / np.sqrt(1.0 - damping**2))
    assert small.max() - 1.0 == pytest.approx(over, abs=0.1)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.1, 0.5])
def test_the_loaded_line_is_a_chain_of_coils_and_capacitors(share, size):
    made, defining, draws = drawn("loaded_line", size, share)
    mean, sections = size * TIME, draws.integers(10, 31)
    assert defining == {"delay": pytest.approx(mean)}
    # Currents, then voltages; the time of a section is 1 and the end is matched.
    matrix = np.zeros((2 * sections, 2 * sections))
    for i in range(sections):
        matrix[i, sections + i] = -1.0
        matrix[sections + i, i] = 1.0
        if i:
            matrix[i, sections + i - 1] = 1.0
            matrix[sections + i - 1, i] = -1.0
    matrix[-1, -1] = -1.0
    still = np.linalg.solve(matrix, -np.eye(2 * sections)[0])
    assert still[-1] == pytest.approx(1.0)
    step = expm(matrix * sections * SUBSTEP / mean)
    state, expected = -still, []
    for _ in range(600):
        state = step @ state
        expected.append(1.0 + state[-1])
    passed = through(made, np.repeat([0.0, 1.0], [1, 600]))[1:]
    np.testing.assert_allclose(passed, expected, atol=0.05)
    np.testing.assert_allclose(np.cumsum(passed - expected) * SUBSTEP, 0.0, atol=0.01 * mean)
    assert passed.max() > 1.05  # the edge rings
    assert np.abs(passed[: round(0.6 * mean / SUBSTEP)]).max() < 0.02


@pytest.mark.parametrize("share", SHARES)
def test_current_tunnels_as_another_integrator_says(share):
    made, defining, draws = drawn("tunnelling_contacts", 0.4, share)
    assert not defining
    scale, time = draws.at(0.05, 0.3) * SPAN, 0.4 * TIME

    def charge(t, v):
        error = np.interp(t, T, WAVE) - v
        return scale / time * np.sinh(error / scale)

    solved = solve_ivp(
        charge, (0.0, T[-1]), WAVE[:1], method="LSODA", max_step=0.005, rtol=1e-8, dense_output=True
    )
    np.testing.assert_allclose(through(made, WAVE), solved.sol(T)[0], atol=0.01 * SPAN)
    # A small step is a lag of its time.
    made = drawn("tunnelling_contacts", 0.4, share)[0]
    small = through(made, np.repeat([1.0, 1.0 + 1e-3 * scale], [1, 500]))[1:] - 1.0
    left = 1.0 - small / (1e-3 * scale)
    np.testing.assert_allclose(left, np.exp(-np.arange(1, 501) * SUBSTEP / time), rtol=1e-4)


@pytest.mark.parametrize("share", SHARES)
def test_the_cups_turn_as_another_integrator_says_and_too_fast_in_gusts(share):
    made, defining, draws = drawn("cup_anemometer", 0.6, share)
    assert made.output
    assert not defining
    below = (0.5 + draws.at(0.1, 0.6)) * TRAVEL
    calm = 0.5 * (BOTTOM + TOP) - below
    length = 0.6 * TIME * below  # of wind, in one lag

    def turn(t, s):
        wind = np.interp(t, T, SWING) - calm
        return wind * (wind + calm - s) / length

    solved = solve_ivp(turn, (0.0, T[-1]), SWING[:1], max_step=0.005, rtol=1e-8, dense_output=True)
    read = through(made, SWING)
    np.testing.assert_allclose(read, solved.sol(T)[0], atol=4e-3 * TRAVEL)
    assert read[1250:].mean() > SWING[1250:].mean() + 0.01 * TRAVEL  # whole periods
    # Hardly any wind is left below the calm.
    made = drawn("cup_anemometer", 0.6, share)[0]
    slow = through(made, np.repeat([calm, calm - 1.0], [1, 1000]))[1:]
    expected = calm - 1.0 + np.exp(-0.05 * np.arange(1, 1001) * SUBSTEP / (0.6 * TIME))
    np.testing.assert_allclose(slow, expected, rtol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_a_corona_charges_above_its_onset_alone(share):
    made, defining, draws = drawn("corona", 0.4, share)
    assert not defining
    time, onset = TIME * draws.log(1.0, 8.0), draws.at(0.3, 0.6)
    low = np.linspace(0.0, 0.99 * onset * HIGH, 500)
    np.testing.assert_array_equal(through(made, low), low)

    def charge(t, m):
        field = np.interp(t, T, WAVE) - m
        current = np.where(field > onset * HIGH, field * (field - onset * HIGH), 0.0)
        return (0.4 * current / (HIGH * (1.0 - onset)) - m) / time

    solved = solve_ivp(charge, (0.0, T[-1]), [0.0], max_step=0.005, rtol=1e-8, dense_output=True)
    expected = WAVE - solved.sol(T)[0]
    np.testing.assert_allclose(through(made, WAVE), expected, atol=2e-3 * HIGH)
    # Then what was charged decays at one rate.
    left = onset * HIGH - through(made, np.full(1000, onset * HIGH))
    decayed = lfilter([1.0], [1.0, SUBSTEP / time - 1.0], np.append(left[:1], np.zeros(999)))
    np.testing.assert_allclose(left, decayed, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("share", SHARES)
def test_the_oscillation_obeys_van_der_pol_s_equation(share):
    made, defining, draws = drawn("relaxation_oscillation", 0.3, share)
    assert made.output
    frequency = 10.0 ** draws.at(-0.7, 0.8) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    bend = draws.at(1.5, 5.0)
    wave = through(made, np.zeros(40_000)) / (0.3 * TRAVEL)
    assert np.abs(wave).max() == pytest.approx(1.0, abs=0.01)

    def move(t, s):
        return [s[1], bend * (1.0 - s[0] ** 2) * s[1] - s[0]]

    # The share of time that it spends at each height, over whole periods.
    solved = solve_ivp(move, (0.0, 400.0), [2.0, 0.0], max_step=0.02, dense_output=True)
    x = solved.sol(np.linspace(200.0, 400.0, 400_000))[0]
    whole = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    x = x[whole[0] : whole[-1]]
    expected = np.quantile(x / np.abs(x).max(), np.linspace(0.02, 0.98, 49))
    found = np.quantile(wave, np.linspace(0.02, 0.98, 49))
    np.testing.assert_allclose(found, expected, atol=0.03)
    rises = np.flatnonzero((wave[:-1] < 0.0) & (wave[1:] >= 0.0))
    assert np.diff(rises).mean() * SUBSTEP == pytest.approx(1.0 / frequency, rel=0.01)
    first = (1.0 - share % 1.0) / frequency
    assert rises[rises > 0][0] * SUBSTEP == pytest.approx(first, abs=0.01 / frequency)


@pytest.mark.parametrize("share", SHARES)
def test_davidson_and_cole_s_lags_answer_a_step_as_a_gamma_distribution(share):
    made, defining, draws = drawn("davidson_cole", 0.6, share)
    assert not made.output
    exponent, mean = draws.at(0.4, 0.8), 0.6 * TIME
    assert defining == {"lag": pytest.approx(mean)}
    risen = through(made, np.repeat([0.0, 1.0], [1, 4000]))[1:]
    # The inverse of 1/(1 + sT)^b over s; hardly any lag is shorter than a sub-step.
    expected = gamma.cdf(np.arange(1, 4001) * SUBSTEP, exponent, scale=mean / exponent)
    np.testing.assert_allclose(risen[20:], expected[20:], atol=0.01)
    assert (1.0 - risen).sum() * SUBSTEP == pytest.approx(mean, abs=SUBSTEP)
    # Its response to a wave of ten periods of its longest lag.
    angular = 2.0 * np.pi / (0.1 * mean / exponent)
    made, t = drawn("davidson_cole", 0.6, share)[0], np.arange(8000) * SUBSTEP
    passed = through(made, np.sin(angular * t))[6000:]
    gain = np.hypot(1.0, angular * mean / exponent) ** -exponent
    assert np.sqrt(2.0 * np.mean(passed**2)) == pytest.approx(gain, rel=0.05)


@pytest.mark.parametrize("share", SHARES)
def test_tubes_charge_as_another_integrator_says(share):
    made, defining, draws = drawn("vacuum_tubes", 0.4, share)
    assert not made.output
    assert not defining
    scale, time = draws.at(0.1, 0.5) * SPAN, 0.4 * TIME

    def charge(t, v):
        error = np.interp(t, T, WAVE) - v
        return np.sign(error) * np.abs(error) ** 1.5 / np.sqrt(scale) / time

    solved = solve_ivp(charge, (0.0, T[-1]), WAVE[:1], max_step=0.005, rtol=1e-8, dense_output=True)
    np.testing.assert_allclose(through(made, WAVE), solved.sol(T)[0], atol=6e-3 * SPAN)
    # A step ends as the inverse square of the time.
    made = drawn("vacuum_tubes", 0.4, share)[0]
    left = 1.0 - through(made, np.repeat([0.0, scale], [1, 4000]))[1:] / scale
    np.testing.assert_allclose(left**-0.5, 1.0 + np.arange(1, 4001) * SUBSTEP / (2.0 * time))


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.01, 0.5])
def test_integrators_and_combs_are_moving_means(share, size):
    made, defining, draws = drawn("comb_filter", size, share)
    assert made.output
    means = draws.integers(3, 6)
    length = max(round(2.0 * size * TIME / means / SUBSTEP) + 1, 2)
    assert defining == {"lag": pytest.approx(0.5 * means * (length - 1) * SUBSTEP)}
    assert defining["lag"] == pytest.approx(size * TIME, abs=0.5 * means * SUBSTEP)
    # Hogenauer's integrators, then as many combs, in whole numbers.
    steps = np.rint(1e3 * SWING).astype(int) - round(1e3 * SWING[0])
    expected = steps.astype(object)
    for _ in range(means):
        expected = np.cumsum(expected)
    for _ in range(means):
        expected = expected - np.concatenate([np.zeros(length, int), expected[:-length]])
    expected = expected.astype(float) / float(length) ** means
    np.testing.assert_allclose(through(made, steps.astype(float)), expected, atol=1e-6)


@pytest.mark.parametrize("share", SHARES)
def test_a_cell_s_carriers_meet_as_another_integrator_says(share):
    made, defining, draws = drawn("photoconductive_cell", 0.6, share)
    assert made.output
    assert not defining
    below = (0.5 + draws.at(0.1, 0.6)) * TRAVEL
    dark = 0.5 * (BOTTOM + TOP) - below

    def free(t, n):
        light = (np.interp(t, T, SWING) - dark) / below
        return 0.5 / (0.6 * TIME) * (light - n**2)

    start = np.sqrt((SWING[:1] - dark) / below)
    solved = solve_ivp(free, (0.0, T[-1]), start, max_step=0.005, rtol=1e-8, dense_output=True)
    read = through(made, SWING)
    np.testing.assert_allclose(read, dark + below * solved.sol(T)[0] ** 2, atol=4e-3 * TRAVEL)
    # A large step up is nearly over sooner than the same step down.
    ends = []
    for levels in ([BOTTOM, TOP], [TOP, BOTTOM]):
        made = drawn("photoconductive_cell", 0.6, share)[0]
        taken = np.abs(through(made, np.repeat(levels, [1, 4000])) - levels[0]) / TRAVEL
        ends.append(np.argmax(taken > 0.95))
    assert ends[0] < ends[1]
    # A small step from the middle of the travel is a lag of its time.
    centre = 0.5 * (BOTTOM + TOP)
    made = drawn("photoconductive_cell", 0.6, share)[0]
    small = through(made, np.repeat([centre, centre + 1e-5], [1, 500]))[1:] - centre
    left = 1.0 - small / 1e-5
    np.testing.assert_allclose(left, np.exp(-np.arange(1, 501) * SUBSTEP / (0.6 * TIME)), rtol=1e-3)
