"""Hidden laws of probes, electrodes, pastes, leaks and echoes, each against another statement."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn, form
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.stats import norm

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN, TIME = UNEVEN.low, UNEVEN.high, UNEVEN.span, UNEVEN.time
BOTTOM, TOP, TRAVEL, LENGTH = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel, UNEVEN.duration
EACH = pytest.mark.parametrize("share", SHARES)
U = command()
T = np.arange(U.size) * SUBSTEP
RECORD = np.arange(round(LENGTH / SUBSTEP)) * SUBSTEP
SWING = BOTTOM + TRAVEL * (0.5 + 0.4 * np.sin(2.0 * np.pi * T / TIME))


@EACH
@pytest.mark.parametrize("size", [0.1, 0.4])
def test_a_paste_flows_as_its_sheared_layers_do(share, size):
    """By rings of a pipe, each of which slips past the next as its stress exceeds the yield."""
    made, defining, _ = drawn("paste_in_pipe", size, share)
    threshold = LOW + size * SPAN
    assert defining == {"threshold": pytest.approx(threshold)}
    radius = (np.arange(20_000) + 0.5) / 20_000

    def flow(u):
        # All within a ring moves with it: the flow of each slip is that over the ring's area.
        return (np.maximum(u * radius - threshold, 0.0) * radius**2).mean()

    places = np.linspace(LOW, 1.5 * HIGH, 60)
    expected = np.array([flow(u) for u in places]) * HIGH / flow(HIGH)
    passed = through(made, places)
    np.testing.assert_allclose(passed, expected, atol=3e-4 * HIGH)
    assert (passed[places < threshold] == 0.0).all()
    assert passed[places > 1.01 * threshold].min() > 0.0


@EACH
def test_a_cubic_ends_level_at_its_limit(share):
    made, defining, draws = drawn("cubic_clipper", 0.5, share)
    limit, room = TOP - 0.5 * TRAVEL, draws.at(0.03, 0.1) * TRAVEL
    assert made.output
    assert defining == {"limit": pytest.approx(limit)}
    y = np.linspace(BOTTOM, TOP, 20_001)
    read = through(made, y)
    # Its slope falls from 1 at the knee as a parabola, to none after one and a half times the room.
    over = np.clip((y - (limit - room)) / (1.5 * room), 0.0, 1.0)
    grown = np.cumsum((1.0 - over**2)[:-1] * np.diff(y))
    np.testing.assert_allclose(read[1:], BOTTOM + grown, atol=3e-4 * TRAVEL)
    assert read[-1] == pytest.approx(limit, abs=1e-4 * TRAVEL)


@EACH
@pytest.mark.parametrize("size", [0.05, 0.6])
def test_the_taps_are_even_about_the_middle_one(share, size):
    made, defining, draws = drawn("transversal_filter", size, share)
    assert defining == {"delay": pytest.approx(size * TIME, abs=0.5 * SUBSTEP)}
    samples = round(2.0 * size * TIME / SUBSTEP) + 50
    pulse = through(made, np.eye(1, samples + 1, 1)[0])[1:]
    taps = np.flatnonzero(np.abs(pulse) > 1e-12)
    assert pulse.sum() == pytest.approx(1.0)
    assert pulse @ np.arange(samples) * SUBSTEP == pytest.approx(defining["delay"])
    assert abs(taps[0] + taps[-1] - 2.0 * size * TIME / SUBSTEP) <= 2.0
    if size > 0.5:  # so far apart that none meets another
        places = np.linspace(0.0, 2.0 * size * TIME / SUBSTEP, 33)
        zeros = draws.at(3.0, 6.0)
        x = np.pi * (np.arange(33) - 16) / zeros
        weights = np.where(x == 0.0, 1.0, np.sin(x) / np.where(x == 0.0, 1.0, x))
        weights *= 0.54 + 0.46 * np.cos(np.pi * (np.arange(33) - 16) / 16.0)
        found = np.zeros(33)
        for tap in taps:
            found[np.abs(places - tap).argmin()] += pulse[tap]
        np.testing.assert_allclose(found, weights / weights.sum(), atol=1e-12)
    # Slow motion comes late and is otherwise unchanged.
    slow = 2.0 + np.sin(2.0 * np.pi * 0.4 / TIME * T)
    late = 2.0 + np.sin(2.0 * np.pi * 0.4 / TIME * (T - defining["delay"]))
    start = samples + 10
    passed = through(drawn("transversal_filter", size, share)[0], slow)
    np.testing.assert_allclose(passed[start:], late[start:], atol=5e-3)


@EACH
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_relaxation_times_are_normal_in_their_logarithms(share, size):
    made, defining, draws = drawn("lognormal_times", size, share)
    mean, deviation = size * TIME, draws.at(0.7, 1.4)
    assert defining == {"lag": pytest.approx(mean)}
    taken = through(made, np.repeat([1.0, 2.0], [1, 3000]))[1:] - 1.0
    # The middles of forty equal shares of the distribution, as the inverse of its integral.
    shares = (np.arange(40) + 0.5) / 40.0
    times = [brentq(lambda x, s=s: norm.cdf(x) - s, -5.0, 5.0) for s in shares]
    times = np.exp(deviation * np.array(times))
    times *= mean / times.mean()
    t = np.arange(1, 3001) * SUBSTEP
    np.testing.assert_allclose(taken, 1.0 - np.exp(-t[:, None] / times).mean(axis=1), atol=1e-9)


@EACH
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_charge_is_transferred_as_another_integrator_says(share, size):
    made, draws = form("charge_transfer", size, share)
    unit, ahead = draws.at(0.05, 0.3) * SPAN, draws.at(0.25, 0.4)
    ahead = ahead if share < 0.5 else 1.0 - ahead
    lag = size * TIME

    def wave(t):
        return LOW + SPAN * (0.5 + 0.45 * np.sin(2.0 * np.pi * 0.7 * t / TIME))

    def charge(t, v):
        x = (wave(t) - v) / unit
        return unit / lag * (np.exp(ahead * x) - np.exp(-(1.0 - ahead) * x))

    solved = solve_ivp(
        charge, (0.0, T[-1]), [wave(0.0)], t_eval=T, rtol=1e-8, atol=1e-9, method="LSODA"
    )
    np.testing.assert_allclose(through(made, wave(T)), solved.y[0], atol=8e-3 * SPAN)
    # A large step is followed in a moment, and quicker on the side of the larger exponent.
    slower = []
    for side in (1.0, -1.0):
        made = form("charge_transfer", size, share)[0]
        passed = through(made, np.repeat([2.0 - side * 8.0 * unit, 2.0], [1, 2000]))[1:]
        slower.append(np.abs(2.0 - passed).sum())
    assert (slower[0] > slower[1]) == (ahead < 0.5)


@EACH
@pytest.mark.parametrize("size", [0.3, 1.0])
def test_oxygen_crosses_a_membrane_as_it_diffuses(share, size):
    made, defining, _ = drawn("oxygen_probe", size, share)
    mean = size * TIME
    assert made.output
    assert defining == {"lag": pytest.approx(mean)}
    taken = through(made, np.repeat([0.0, 1.0], [1, 3000]))[1:]
    # Thickness² over diffusivity is six times the mean delay; all is used up at the electrode.
    t = np.arange(1, 3001) * SUBSTEP / (6.0 * mean)
    order = np.arange(1, 200)
    series = ((-1.0) ** order * np.exp(-np.outer(t, (np.pi * order) ** 2))).sum(axis=1)
    late = t > 0.02
    np.testing.assert_allclose(taken[late], (1.0 + 2.0 * series)[late], atol=0.015)


@EACH
@pytest.mark.parametrize("size", [0.1, 0.6])
def test_particles_are_dragged_as_another_integrator_says(share, size):
    made, draws = form("tracer_particles", size, share)
    reynolds, lag = draws.at(20.0, 200.0), size * TIME
    assert made.output

    def drag(t, y):
        error = np.interp(t, T, SWING) - y
        return error / lag * (1.0 + 0.15 * (reynolds * abs(error) / TRAVEL) ** 0.687)

    solved = solve_ivp(drag, (0.0, T[-1]), SWING[:1], t_eval=T, rtol=1e-8, max_step=5e-3)
    np.testing.assert_allclose(through(made, SWING), solved.y[0], atol=4e-3 * TRAVEL)
    assert np.abs(SWING - solved.y[0]).max() > 0.05 * TRAVEL


@EACH
@pytest.mark.parametrize("size", [0.1, 1.0])
def test_a_leak_is_there_from_its_moment_on(share, size):
    made, defining, draws = drawn("leaking_actuator", size, share)
    moment, width = draws.at(0.3, 0.7) * LENGTH, draws.at(0.01, 0.1) * TIME
    assert defining == {"time": pytest.approx(moment)}
    moves = np.resize(U, RECORD.size)
    passed = through(made, moves)
    before, after = moment - 1.5e-3 > RECORD, moment + width + 1.5e-3 < RECORD
    np.testing.assert_array_equal(passed[before], moves[before])
    lost = (moves - passed)[after]
    open_now = passed[after] > 0.0
    # Bernoulli: the square of what is lost is in proportion to the command.
    squares = (size * SPAN) ** 2 * moves[after] / HIGH
    np.testing.assert_allclose(lost[open_now] ** 2, squares[open_now], rtol=1e-9)
    assert (passed >= 0.0).all()
    partly = ~before & ~after
    assert (moves - passed)[partly].max() <= lost.max()


@EACH
def test_a_level_moves_in_part_at_once_and_then_settles(share):
    made, defining, draws = drawn("intervened_level", 0.2, share)
    moment = draws.at(0.3, 0.7) * LENGTH
    time, height = draws.at(0.3, 1.0) * TIME, 0.2 * TRAVEL * draws.side()
    assert made.output
    assert defining == {"time": pytest.approx(moment)}
    added = through(made, np.zeros(RECORD.size)) / height
    first = np.flatnonzero(added)[0]
    assert first * SUBSTEP == pytest.approx(moment, abs=1.5 * SUBSTEP)
    assert added[first] == pytest.approx(draws.at(0.3, 0.7), abs=0.01)
    # Box and Tiao's filter of first order: what is left becomes less by the same factor each time.
    left = 1.0 - added[first:][:800]
    np.testing.assert_allclose(left[1:] / left[:-1], np.exp(-SUBSTEP / time), rtol=1e-6)


@EACH
def test_a_cnoidal_wave_is_jacobi_s_by_its_elliptic_integral(share):
    made, defining, draws = drawn("cnoidal_wave", 0.1, share)
    most = min(0.8, np.log10(0.4 * UNEVEN.rate * TIME))
    frequency = 10.0 ** draws.at(-0.7, most) / TIME
    assert made.output
    assert defining == {"frequency": pytest.approx(frequency)}
    wave = through(made, np.zeros(8000)) / (0.1 * TRAVEL)
    place = (np.arange(8000) * SUBSTEP * frequency + draws.random()) % 1.0
    narrow = draws.at(0.7, 0.98)
    angles = np.linspace(0.0, np.pi, 401)
    ways = [quad(lambda a: (1.0 - narrow * np.sin(a) ** 2) ** -0.5, 0.0, end)[0] for end in angles]
    turned = np.array(ways) / ways[-1]
    heights = 2.0 * np.interp(place, turned, np.cos(angles) ** 2)
    mean = 2.0 * np.trapezoid(np.cos(angles) ** 2, turned)
    np.testing.assert_allclose(wave, heights - mean, atol=3e-3)
    assert np.mean(wave > 0.0) < 0.5


@EACH
@pytest.mark.parametrize("size", [0.05, 0.6])
def test_an_echo_is_a_ripple_of_the_spectrum(share, size):
    made, draws = form("echoed_reading", size, share)
    assert made.output
    late, part = round(draws.at(2.0, 6.0) * TIME / SUBSTEP), size * draws.side()
    pulse = through(made, np.eye(1, 8192, 1)[0])[1:] * (1.0 + part)
    assert pulse[0] == pytest.approx(1.0)
    assert pulse[late] == pytest.approx(part)
    assert np.count_nonzero(pulse) == 2
    # Bogert's cepstrum: powers of the echo over their orders, at multiples of its time.
    cepstrum = np.fft.ifft(np.log(np.fft.fft(pulse, 65_536))).real
    expected = [-((-part) ** n) / n for n in (1, 2, 3)]
    np.testing.assert_allclose(cepstrum[late * np.arange(1, 4)], expected, atol=1e-6)
    still = np.full(500, 3.0)
    np.testing.assert_allclose(through(form("echoed_reading", size, share)[0], still), still)


@EACH
def test_dynamic_pressure_is_the_square_of_the_speed_and_has_no_side(share):
    made, draws = form("dynamic_pressure", 0.01, share)
    assert made.output
    speeds = UNEVEN.speed * np.array([-2.0, -1.0, 1.0, 3.0])
    path = 5.0 + np.concatenate([[0.0], np.cumsum(np.repeat(speeds, 200) * SUBSTEP)])
    error = (through(made, path) - path)[1:].reshape(4, 200)
    expected = 0.01 * TRAVEL * draws.side() * np.array([4.0, 1.0, 1.0, 9.0])
    np.testing.assert_allclose(error, np.repeat(expected, 200).reshape(4, 200), rtol=1e-6)
