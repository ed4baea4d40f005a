"""Hidden laws of command and reading against another statement of each, draw by draw."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, held, resist, through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.signal import lfilter
from scipy.stats import norm

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN = UNEVEN.low, UNEVEN.high, UNEVEN.span
BOTTOM, TOP, TRAVEL, TIME = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel, UNEVEN.time
LAST = UNEVEN.duration
PLACES = np.linspace(0.05, 1.6 * HIGH, 800)
Y = np.linspace(BOTTOM - 0.1 * TRAVEL, TOP + 0.1 * TRAVEL, 1200)
U = command()
T = np.arange(U.size) * SUBSTEP


def cracking_valve(size, d):
    threshold = LOW + size * SPAN
    constant = d.at(0.5, 0.8)
    pressure = HIGH * constant + PLACES * (1.0 - constant)
    flow = np.where(threshold < PLACES, (PLACES - threshold) * pressure**0.5, 0.0)
    return flow * HIGH / ((HIGH - threshold) * HIGH**0.5)


def peak_limiter(size, d):
    # The slope between logarithms falls in a straight line from 1 to one over the ratio.
    limit, ratio, width = np.log(HIGH - size * SPAN), d.at(4.0, 10.0), d.at(0.04, 0.2)
    fine = np.linspace(np.log(0.04), np.log(1.7 * HIGH), 200_001)
    fallen = np.clip((fine - limit) / width + 0.5, 0.0, 1.0)
    slopes = 1.0 - (1.0 - 1.0 / ratio) * fallen
    grown = fine[0] + np.concatenate([[0.0], np.cumsum(slopes[1:] * np.diff(fine))])
    return np.exp(np.interp(np.log(PLACES), fine, grown))


def magnetic_core(size, d):
    limit, steep = HIGH - size * SPAN, d.at(5.0, 12.0)

    def field(v):
        return v * (1 + np.exp(steep * (v**2 / limit**2 - 1)) - np.exp(-steep))

    return np.array([brentq(lambda v, u=u: field(v) - u, 0.0, 3.0 * limit) for u in PLACES])


@pytest.mark.parametrize("law", [cracking_valve, peak_limiter, magnetic_core])
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 0.44])
def test_a_command_passes_as_the_law_says(law, share, size):
    made, defining, draws = drawn(law.__name__, size, share)
    np.testing.assert_allclose(through(made, PLACES), law(size, draws), atol=3e-4 * HIGH)
    ends = {"threshold": LOW + size * SPAN, "limit": HIGH - size * SPAN}
    assert defining
    for name, value in defining.items():
        assert value == pytest.approx(ends[name])


def logarithmic_pixel(size, d):
    knee, room = TOP - size * TRAVEL, d.at(0.01, 0.04) * TRAVEL
    return np.minimum(Y, knee) + room * np.log(1.0 + np.maximum(Y - knee, 0.0) / room)


def mismatched_bits(size, d):
    """Of a converter whose code is written in bits."""
    height = 0.2 * min(size, 1.0) * TRAVEL * d.side() * d.at(0.3, 1.0)
    codes = np.clip(16 * (Y - BOTTOM) / TRAVEL, 0, 15.999).astype(int)
    wrong = [sum(int(b) * 2 ** (-i / 2) for i, b in enumerate(f"{code:04b}")) for code in codes]
    read = Y + height * np.array(wrong)
    edge = np.abs((16 * (Y - BOTTOM) / TRAVEL + 0.5) % 1.0 - 0.5) < 0.05
    return np.where(edge, np.nan, read)


def optical_lever(size, d):
    turn, centre = 0.8 * min(size, 1.25), d.at(-0.3, 0.3)
    angle = turn * ((Y - UNEVEN.bottom) / (0.5 * TRAVEL) - 1.0 - centre)
    read = UNEVEN.median + 0.5 * TRAVEL * np.sin(angle) / np.cos(angle) / turn
    return np.where(np.abs(angle) < 1.28, read, np.nan)


def true_at_ends(signal):
    """Return a reading that is a signal of the place, between its values at both ends."""
    low, high = signal(BOTTOM), signal(TOP)
    return BOTTOM + TRAVEL * (signal(Y) - low) / (high - low)


def light_probe(size, d):
    nearest = d.at(0.7, 1.3) * TRAVEL / size
    target = TOP + nearest if d.share < 0.5 else BOTTOM - nearest
    return true_at_ends(lambda y: (nearest / (y - target)) ** 2)


def knife_edge(size, d):
    # What a Gaussian beam, twice as wide as its standard deviation, has on one side of the edge.
    centre = 0.5 * (BOTTOM + TOP) + d.at(-0.4, 0.4) * 0.5 * TRAVEL
    deviation = 0.5 * TRAVEL / (1.2 * min(size, 1.25)) / np.sqrt(2.0)
    return true_at_ends(norm(centre, deviation).cdf)


@pytest.mark.parametrize(
    "law", [logarithmic_pixel, mismatched_bits, optical_lever, light_probe, knife_edge]
)
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 0.44, 1.4])
def test_a_reading_is_bent_as_the_law_says(law, share, size):
    made, defining, draws = drawn(law.__name__, size, share)
    assert made.output
    assert not defining
    expected = law(size, draws)
    known = np.isfinite(expected)
    np.testing.assert_allclose(through(made, Y)[known], expected[known], atol=5e-4 * TRAVEL)


def bounded(rate):
    """Return the command followed at no more than a rate."""
    place, followed = U[0], []
    for u in U:
        place = np.clip(u, place - rate * SUBSTEP, place + rate * SUBSTEP)
        followed.append(place)
    return np.array(followed)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.4, 2.0])
def test_the_ramp_is_averaged_over_its_window(share, size):
    made, defining, draws = drawn("smoothed_ramp", size, share)
    rate = SPAN / (size * TIME)
    assert defining == {"rate": pytest.approx(rate)}
    window = max(round(draws.at(0.05, 0.25) * size * TIME / SUBSTEP), 2)
    ahead = np.concatenate([np.full(window - 1, U[0]), bounded(rate)])
    expected = np.convolve(ahead, np.full(window, 1.0 / window), mode="valid")
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_motor_runs_at_its_rate_from_its_band_on_until_it_is_there(share):
    made, defining, draws = drawn("switched_motor", 1.0, share)
    rate, band = defining["rate"], draws.at(0.002, 0.008) * SPAN
    assert rate == pytest.approx(SPAN / TIME)
    passed = through(made, U)
    before, moved = np.append(U[0], passed[:-1]), np.diff(passed, prepend=U[0])
    running = np.abs(moved) > 0.0
    full = np.isclose(np.abs(moved), rate * SUBSTEP, rtol=1e-6)
    np.testing.assert_allclose(passed[running & ~full], U[running & ~full])
    starts = running & ~np.append(False, running[:-1])
    assert (np.abs(U - before)[starts] > band).all()
    resting = ~running & ~np.append(False, running[:-1])
    assert (np.abs(U - before)[resting] <= band).all()
    assert np.count_nonzero(resting) > 100


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.05, 0.4])
def test_the_buckets_pass_on_all_but_what_they_leave(share, size):
    made, defining, draws = drawn("bucket_brigade", size, share)
    mean = size * TIME / SUBSTEP
    period = max(round(mean / draws.integers(16, 49)), 1)
    buckets, left = round(mean / period), draws.at(0.002, 0.015)
    charge = U[::period] - U[0]
    for k in range(buckets):
        # The first bucket takes what comes at the clock, the others what their neighbour had.
        charge = lfilter([1.0 - left] if k == 0 else [0.0, 1.0 - left], [1.0, -left], charge)
    expected = np.repeat(charge, period)[: U.size] + U[0]
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    slope = through(drawn("bucket_brigade", size, share)[0], T)
    assert (T - slope)[2000:].mean() == pytest.approx(defining["delay"], abs=2e-4)


def test_the_samples_are_joined_one_period_late():
    made, defining, _ = drawn("joined_samples", 0.2, 0.3)
    period = round(0.2 * TIME / SUBSTEP)
    assert defining == {"delay": pytest.approx(period * SUBSTEP)}
    expected = np.interp(T - period * SUBSTEP, T[::period], U[::period])
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_bleeder_discharges_as_another_integrator_says(share):
    made, defining, draws = drawn("bleeder_resistor", 0.3, share)
    assert not defining
    ratio = draws.at(2.0, 5.0)
    quick = 2.0 * 0.3 * TIME / (1.0 + ratio)
    wave = 2.0 + np.sin(9.0 * T)

    def charge(t, v):
        error = 2.0 + np.sin(9.0 * t) - v
        return error / np.where(error > 0.0, quick, ratio * quick)

    solved = solve_ivp(charge, (0.0, T[-1]), [2.0], max_step=0.01, rtol=1e-8, dense_output=True)
    np.testing.assert_allclose(through(made, wave), solved.sol(T)[0], atol=6e-3)


def test_the_bead_is_the_mean_over_shells_of_a_sphere():
    """By shells that pass heat to each other; the mean delay of a sphere is R²/15a."""
    made, defining, _ = drawn("thermistor_bead", 0.8, 0.3)
    mean = 0.8 * TIME
    assert defining == {"lag": pytest.approx(mean)}
    shells = 60
    edges = np.linspace(0.0, 1.0, shells + 1)
    volumes, between = np.diff(edges**3) / 3.0, edges[1:-1] ** 2 * shells
    flow = np.diag(between, 1) + np.diag(between, -1)
    flow -= np.diag(flow.sum(axis=1))
    flow[-1, -1] -= 2.0 * shells  # half a shell from the surface
    rates, shapes = np.linalg.eigh(flow / np.sqrt(np.outer(volumes, volumes)))
    weights = (np.sqrt(volumes) @ shapes) ** 2 * 3.0
    seconds = 15.0 * mean
    time = np.arange(20, 1500, 30)
    expected = 1.0 - np.exp(np.outer(time * SUBSTEP, rates / seconds)) @ weights
    step = through(made, np.repeat([0.0, 1.0], [1, 2000]))[1:]
    np.testing.assert_allclose(step[time - 1], expected, atol=5e-3)


@pytest.mark.parametrize("share", SHARES)
def test_traps_fill_as_another_integrator_says(share):
    made, _, draws = drawn("filling_traps", 0.4, share)
    ratio, emission = draws.at(1.0, 5.0), TIME * draws.log(2.0, 16.0)
    whole = 0.4 * HIGH * (1.0 + ratio) / ratio

    def fill(t, m):
        field = np.maximum(2.5 + 1.4 * np.sin(4.0 * t) - m, 0.0) / HIGH
        return (ratio * field * (whole - m) - m) / emission

    solved = solve_ivp(fill, (0.0, T[-1]), [0.0], max_step=0.01, rtol=1e-8, dense_output=True)
    wave = 2.5 + 1.4 * np.sin(4.0 * T)
    expected = np.maximum(wave - solved.sol(T)[0], 0.0)
    np.testing.assert_allclose(through(made, wave), expected, atol=2e-3)


def wearing_gain(t, d):
    return (t / LAST) ** d.at(1.5, 3.0)


def crystallising_gain(t, d):
    return 1.0 - np.exp(-((t / (d.at(0.35, 0.7) * LAST)) ** d.at(2.0, 3.5)))


@pytest.mark.parametrize("law", [wearing_gain, crystallising_gain])
@pytest.mark.parametrize("share", SHARES)
def test_a_gain_drifts_as_the_law_says(law, share):
    made, _, draws = drawn(law.__name__, 0.3, share)
    change = 0.3 * draws.sign(0.3) * law(np.minimum(T, LAST), draws)
    expected = U * (1.0 + change) ** (1.0 / UNEVEN.power)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-5 * HIGH)


@pytest.mark.parametrize("share", SHARES)
def test_the_bed_consolidates_as_a_layer_that_drains(share):
    """By slices of a layer that is drained at one face."""
    made, _, draws = drawn("consolidating_bed", 0.3, share)
    slices = 150
    flow = np.diag(np.ones(slices - 1), 1) + np.diag(np.ones(slices - 1), -1)
    flow -= np.diag(flow.sum(axis=1))
    flow[0, 0] -= 2.0
    rates, shapes = np.linalg.eigh(flow * slices**2)
    weights = shapes.sum(axis=0) ** 2 / slices
    seconds = draws.at(0.2, 0.6) * LAST * np.pi**2 / 4.0
    times = np.arange(100, 3900, 100)
    settled = 1.0 - np.exp(np.outer(times * SUBSTEP, rates / seconds)) @ weights
    added = through(made, np.zeros(4000))[times]
    np.testing.assert_allclose(added, 0.3 * TRAVEL * draws.side() * settled, atol=3e-3 * TRAVEL)


def ramp(d):
    moment, width = d.at(0.3, 0.7) * LAST, d.at(0.01, 0.1) * TIME
    return moment, np.clip((T - moment) / width, 0.0, 1.0)


@pytest.mark.parametrize("share", SHARES)
def test_the_sensor_s_scale_and_the_load_change_at_a_moment(share):
    made, defining, draws = drawn("rescaled_sensor", 0.3, share)
    moment, risen = ramp(draws)
    assert made.output
    assert defining == {"time": pytest.approx(moment)}
    expected = UNEVEN.rest + (U - UNEVEN.rest) * (1.0 + 0.3 * draws.sign(0.3) * risen)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    load, defining, draws = drawn("dropped_load", 0.3, share)
    assert defining == {"time": pytest.approx(moment)}
    expected = 0.3 * UNEVEN.stiffness * TRAVEL * draws.side() * risen
    felt = held(load, 4.0, T.size * SUBSTEP)
    np.testing.assert_allclose(felt[:-1], expected[1:], atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_thickened_oil_is_felt_in_proportion_to_the_speed(share):
    made, defining, draws = drawn("thickened_oil", 0.3, share)
    moment, risen = ramp(draws)
    assert defining == {"time": pytest.approx(moment)}
    path = 4.0 + 2.0 * np.sin(2.0 * np.pi * T / TIME)
    speeds = np.diff(path) / SUBSTEP
    # An amplitude at the edge of the band is resisted as by 0.3 stiffnesses.
    dashpot = 0.3 * UNEVEN.stiffness / (2.0 * np.pi / TIME)
    felt = resist(made, path)[1:-1]
    np.testing.assert_allclose(felt, dashpot * speeds[:-1] * risen[2:], atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_machine_hunts_about_its_frequency(share):
    made, defining, draws = drawn("hunting_machine", 0.3, share)
    frequency = 10.0 ** draws.at(-0.7, 0.8) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    phase, swing = draws.at(0.0, 2.0 * np.pi), draws.at(0.3, 0.9)
    slow = frequency * draws.at(0.05, 0.2)
    # The phase is the integral of a frequency that swings about its mean.
    fine = np.arange(0.0, T[-1] + 1e-9, SUBSTEP / 10.0)
    momentary = frequency + swing * slow * np.cos(2.0 * np.pi * slow * fine + phase)
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (momentary[1:] + momentary[:-1]))])
    angle = 2.0 * np.pi * turned[::10] * SUBSTEP / 10.0 + phase + swing * np.sin(phase)
    expected = U + 0.3 * TRAVEL * np.sin(angle)
    np.testing.assert_allclose(through(made, U), expected, atol=2e-3 * TRAVEL)


@pytest.mark.parametrize("seed", range(3))
def test_a_chopper_s_pulses_have_no_mean(seed):
    law, defining = built("periodic_disturbance", "chopped_supply", 0.1, seed)
    period = 1.0 / defining["frequency"]
    wave = through(law, np.zeros(round(40.0 * period / SUBSTEP)))
    low, high = np.unique(np.round(wave, 9))
    assert high - low == pytest.approx(0.2 * CONDITIONS.span)
    assert abs(wave.mean()) < 0.01 * (high - low)
    assert 0.28 < np.mean(wave > 0.0) < 0.72
    rises = np.flatnonzero(np.diff(wave) > 0.0)
    assert np.diff(rises).mean() * SUBSTEP == pytest.approx(period, rel=0.01)
