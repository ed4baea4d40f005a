"""Hidden lags of command and reading against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import bessel, cont2discrete, lfilter, lfiltic
from scipy.special import jv

from dea.plant.film import SUBSTEP

LOW, SPAN, TIME = UNEVEN.low, UNEVEN.span, UNEVEN.time
U = command()
U[0] += 0.01
T = np.arange(U.size) * SUBSTEP
SENSORS = {
    "seismic_element", "integrating_converter", "bare_thermometer", "buried_sensor",
    "thermistor_bead", "bessel_filter", "sheathed_probe",
}  # fmt: skip
# A signal and a step whose first value has lasted for ever.
STEP = np.repeat([2.0, 3.0], [1, 4000])


def made_lag(form, size, share):
    """Return a form's law, its draws and its mean delay, ``size`` band periods."""
    made, defining, draws = drawn(form, size, share)
    assert defining == {"lag": pytest.approx(size * TIME)}
    assert made.output is (form in SENSORS)
    return made, draws, size * TIME


def implicit(signal, time):
    """Return a first-order lag by Euler's implicit rule, whose mean delay is its time."""
    kept = time / (time + SUBSTEP)
    return _settled([1.0 - kept], [1.0, -kept], signal)


def exact(signal, time):
    """Return a first-order lag of what is held over each sub-step."""
    kept = np.exp(-SUBSTEP / time)
    return _settled([1.0 - kept], [1.0, -kept], signal)


def exact_filter(numerator, denominator, signal):
    """Return a filter in s of what is held over each sub-step, and then read."""
    b, a, _ = cont2discrete((numerator, denominator), SUBSTEP, method="zoh")
    # A value is taken at the beginning of a sub-step, and read at its end.
    ahead = np.append(b.ravel()[1:], 0.0)
    return _settled(ahead, a, signal)


def _settled(b, a, signal):
    count = max(len(a), len(b))
    start = lfiltic(b, a, np.full(count, signal[0]), np.full(count, signal[0]))
    return lfilter(b, a, signal, zi=start)[0]


@pytest.mark.parametrize("size", [0.05, 0.4])
def test_a_cable_is_a_ladder_of_equal_resistors_and_capacitors(size):
    made, _, mean = made_lag("cable_diffusion", size, 0.3)
    rungs = 6
    ladder = np.diag(np.ones(rungs - 1), 1) + np.diag(np.ones(rungs - 1), -1) - 2.0 * np.eye(rungs)
    ladder[-1, -1] = -1.0
    delay = np.linalg.inv(-ladder).sum() / rungs
    rate = expm(ladder * SUBSTEP * delay / mean)
    left, expected = np.ones(rungs), []
    for _ in range(4000):
        left = rate @ left
        expected.append(3.0 - left.mean())
    np.testing.assert_allclose(through(made, STEP)[1:], expected, atol=6e-3)


@pytest.mark.parametrize("share", SHARES)
def test_two_stages_follow_each_other(share):
    made, draws, mean = made_lag("two_stages", 0.3, share)
    first = draws.at(0.55, 0.8) * mean
    expected = implicit(implicit(U, first), mean - first)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_circuit_of_r_l_and_c_is_exact_for_held_values(share):
    made, draws, mean = made_lag("lead_inductance", 0.3, share)
    damping = draws.at(0.8, 0.95)
    angular = 2.0 * damping / mean
    expected = exact_filter([angular**2], [1.0, 2.0 * damping * angular, angular**2], U)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_a_disc_is_charged_through_its_rim_as_carslaw_and_jaeger_s_series(share):
    made, draws, mean = made_lag("rim_contact", 0.4, share)
    ratio = draws.at(2.0, 20.0)
    # Roots of b J1(b) = B J0(b), by bisection between changes of sign; then Crank's weights.
    edges = np.linspace(1e-6, 300.0, 30_001)
    values = edges * jv(1, edges) - ratio * jv(0, edges)
    change = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    low, high = edges[change], edges[change + 1]
    roots = low - values[change] * (high - low) / (values[change + 1] - values[change])
    weights = 4.0 * ratio**2 / (roots**2 * (roots**2 + ratio**2))
    # The mean delay in units of the disc's own time: of the disc, and of its contact.
    whole = mean / (1.0 / 8.0 + 1.0 / (2.0 * ratio))
    t = np.arange(1, 4001) * SUBSTEP
    expected = 3.0 - np.exp(-np.outer(t / whole, roots**2)) @ weights
    risen = through(made, STEP)[1:]
    np.testing.assert_allclose(risen[10:], expected[10:], atol=2e-3)
    assert (3.0 - risen).sum() * SUBSTEP == pytest.approx(mean, abs=0.51 * SUBSTEP)


@pytest.mark.parametrize("share", SHARES)
def test_a_bleeder_s_charge_is_slower_away_than_it_came(share):
    made, defining, draws = drawn("bleeder_resistor", 0.3, share)
    assert not defining
    assert not made.output
    ratio = draws.at(2.0, 5.0)
    quick = 0.6 * TIME / (1.0 + ratio)
    risen = through(made, np.repeat([1.0, 3.0, 1.0], [1, 3000, 3000]))[1:]
    t = np.arange(1, 3001) * SUBSTEP
    np.testing.assert_allclose(risen[:3000], 3.0 - 2.0 * np.exp(-t / quick), atol=1e-9)
    fallen = 1.0 + (risen[2999] - 1.0) * np.exp(-t / (ratio * quick))
    np.testing.assert_allclose(risen[3000:], fallen, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_cole_and_cole_s_lags_have_their_permittivity(share):
    made, defining, draws = drawn("cole_cole", 0.3, share)
    assert not defining
    assert not made.output
    alpha, middle = draws.at(0.15, 0.35), 0.3 * TIME
    # Of seventeen lags from exp(-4) to exp(4) times the middle, their density over the logarithm.
    ratios = np.linspace(-4.0, 4.0, 17)
    density = 1.0 / (np.cosh((1.0 - alpha) * ratios) - np.cos(alpha * np.pi))
    lags = [w * exact(U, middle * np.exp(r)) for w, r in zip(density, ratios, strict=True)]
    np.testing.assert_allclose(through(made, U), sum(lags) / density.sum(), atol=1e-9)
    # Around the middle they have the response 1/(1 + (iw)^(1 - a)).
    waves = 1j * np.array([0.5, 1.0, 2.0])
    found = (density[:, None] / (1.0 + np.outer(np.exp(ratios), waves))).sum(axis=0) / density.sum()
    np.testing.assert_allclose(found, 1.0 / (1.0 + waves ** (1.0 - alpha)), atol=0.03)


@pytest.mark.parametrize("share", SHARES)
def test_the_stretched_electrode_s_time_grows_with_its_level(share):
    made, draws, mean = made_lag("stretched_electrode", 0.5, share)
    growth = draws.at(0.5, 2.0)
    wave = LOW + SPAN * (0.5 + 0.8 * np.sin(2.0 * np.pi * 0.7 * T))

    def charge(t, v):
        level = np.clip((v - LOW) / SPAN, 0.0, 1.0)
        time = mean * (1.0 + growth * level) / (1.0 + 0.5 * growth)
        return (np.interp(t, T, wave) - v) / time

    solved = solve_ivp(charge, (0.0, T[-1]), wave[:1], max_step=0.005, rtol=1e-8, dense_output=True)
    np.testing.assert_allclose(through(made, wave), solved.sol(T)[0], atol=8e-3 * SPAN)
    for start, level in ((LOW - SPAN, 0.0), (LOW + 0.5 * SPAN, 0.5), (LOW + 2.0 * SPAN, 1.0)):
        made = drawn("stretched_electrode", 0.5, share)[0]
        small = through(made, start + 1e-6 * (STEP - 2.0))[1:1000]
        time = mean * (1.0 + growth * level) / (1.0 + 0.5 * growth)
        left = 1.0 - (small - start) / 1e-6
        np.testing.assert_allclose(left, np.exp(-np.arange(1, 1000) * SUBSTEP / time), atol=1e-6)


@pytest.mark.parametrize("size", [0.001, 0.01, 0.3])
def test_a_converter_takes_the_mean_over_two_values_at_least(size):
    made, defining, _ = drawn("integrating_converter", size, 0.3)
    window = max(round(2.0 * size * TIME / SUBSTEP), 2)
    assert made.output
    ahead = np.concatenate([np.full(window - 1, U[0]), U])
    expected = np.convolve(ahead, np.full(window, 1.0 / window), mode="valid")
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    late = T - through(drawn("integrating_converter", size, 0.3)[0], T)
    assert defining == {"lag": pytest.approx(late[-1], rel=1e-6)}
    assert late[-1] == pytest.approx(size * TIME, abs=SUBSTEP)


@pytest.mark.parametrize("share", SHARES)
def test_a_seismic_element_is_followed_by_its_filter(share):
    made, draws, mean = made_lag("seismic_element", 0.8, share)
    damping, behind = draws.at(0.55, 1.2), draws.at(0.1, 0.4) * mean
    angular = 2.0 * damping / (mean - behind)
    element = [1.0, 2.0 * damping * angular, angular**2]
    expected = exact(exact_filter([angular**2], element, U), behind)
    np.testing.assert_allclose(through(made, U), expected, atol=0.01 * SPAN)
    left = 3.0 - through(drawn("seismic_element", 0.8, share)[0], STEP)[1:]
    assert left.sum() * SUBSTEP == pytest.approx(mean, abs=1.01 * SUBSTEP)
    # Of a step, the first three sub-steps are a product of three small shares.
    share_of_filter = SUBSTEP / (behind + SUBSTEP)
    assert 1.0 - left[0] == pytest.approx((angular * SUBSTEP) ** 2 * share_of_filter, rel=1e-9)


def test_a_thermometer_is_one_lag():
    made, _, mean = made_lag("bare_thermometer", 0.3, 0.3)
    np.testing.assert_allclose(through(made, U), implicit(U, mean), atol=1e-9)


def test_a_buried_sensor_has_the_poles_of_a_slab():
    made, _, mean = made_lag("buried_sensor", 0.6, 0.3)
    # Those of 1/cosh of the root of s, at odd multiples of a quarter turn.
    times = [4.0 / (np.pi * (2 * n + 1)) ** 2 for n in range(12)]
    expected = U
    for time in times:
        expected = implicit(expected, mean * time / sum(times))
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


def test_a_bead_has_the_lags_of_a_sphere_and_its_mean_delay():
    made, _, mean = made_lag("thermistor_bead", 0.6, 0.3)
    order = np.arange(1, 31)
    weights = 6.0 / (np.pi * order) ** 2
    weights[-1] = 1.0 - weights[:-1].sum()
    scale = mean / (weights @ order**-2.0)
    lags = [w * exact(U, scale / n**2) for w, n in zip(weights, order, strict=True)]
    np.testing.assert_allclose(through(made, U), sum(lags), atol=1e-9)


def test_the_bessel_filter_is_exact_for_held_values():
    made, _, mean = made_lag("bessel_filter", 0.3, 0.3)
    numerator, denominator = bessel(4, 1.0 / mean, analog=True, norm="delay")
    np.testing.assert_allclose(through(made, U), exact_filter(numerator, denominator, U), atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_a_part_of_the_probe_is_behind_its_sheath(share):
    made, draws, mean = made_lag("sheathed_probe", 0.5, share)
    quick = draws.at(0.1, 0.35)
    # The quick part brings three hundredths of the mean delay.
    parts = quick * exact(U, 0.03 * mean / quick)
    parts += (1.0 - quick) * exact(U, 0.97 * mean / (1.0 - quick))
    np.testing.assert_allclose(through(made, U), parts, atol=1e-9)
