"""Each law against an implementation that shares nothing with it."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_values import DT, SCALES, values
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline
from scipy.linalg import expm
from scipy.optimize import brentq, least_squares
from scipy.signal import cont2discrete, lfilter, lfilter_zi, lti

from dea.simulation import Port, catalogue
from dea.simulation.effects._laws import DRIFT_MODES, drift_modes, low_pass
from dea.simulation.effects.sensor_nonlinearity import MODES, curve_modes
from dea.simulation.effects.strain_stiffening import MODES as STIFFNESS_MODES
from dea.simulation.effects.strain_stiffening import curve_modes as stiffness_modes
from dea.simulation.signatures import MEMORY, SLOTS, no_force, no_update

T = np.arange(2000) * DT
U = 2.4 + np.sin(2 * np.pi * 0.31 * T) * np.cos(2 * np.pi * 0.05 * T)
Y = 0.8 + 0.4 * np.sin(2 * np.pi * 0.23 * T)
Z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.4 * T) * np.cos(2 * np.pi * 0.03 * T)


def forces(name, q, z=Z, h=DT):
    """The force along a given motion."""
    effect = catalogue()[name]
    memory = effect.memory(q) if effect.memory else np.zeros(MEMORY)
    result = []
    for k in range(z.size - 1):
        result.append(effect.force(z[k], (z[k + 1] - z[k]) / h, memory, q))
        effect.update(z[k], z[k + 1], h, memory, q)
    return np.array(result)


def test_the_catalogue_holds_the_effects_of_four_ports():
    ports = {port: {e.name for e in catalogue().values() if e.port is port} for port in Port}
    assert ports[Port.INPUT] == {
        "dead_zone", "input_saturation", "slew_limit", "transport_delay", "electrode_lag",
        "charge_leakage",
    }  # fmt: skip
    assert ports[Port.FORCE] == {
        "viscoelastic_creep", "rate_independent_hysteresis", "coulomb_friction",
        "strain_stiffening", "cyclic_softening", "second_mode", "end_stop", "stress_relaxation",
    }  # fmt: skip
    assert ports[Port.TIME] == {"gain_drift", "baseline_drift", "step_fault"}
    assert ports[Port.OUTPUT] == {
        "sensor_lag", "output_saturation", "sensor_nonlinearity", "periodic_disturbance",
        "backlash",
    }  # fmt: skip


@pytest.mark.parametrize("effect", catalogue().values(), ids=lambda e: e.name)
def test_an_effect_is_complete(effect):
    parameters = effect.parameters(SCALES)
    assert effect.defining in {"", *(p.name for p in parameters if p.spread > 0)}
    assert len({p.name for p in parameters}) == len(parameters)
    assert any(p.spread > 0 for p in parameters)
    assert all(p.low <= p.nominal <= p.high for p in parameters)
    assert all(p.nominal > 0.0 for p in parameters if p.log)
    assert effect.symptom
    assert effect.citation
    assert effect.starts(SCALES)
    for start in effect.starts(SCALES):
        assert len(start) == len(parameters)
        assert all(p.low <= v <= p.high for p, v in zip(parameters, start, strict=True))
        known = [(p, v) for p, v in zip(parameters, start, strict=True) if p.spread == 0.0]
        assert all(v == p.nominal for p, v in known)


def test_dead_zone_subtracts_its_threshold_and_lets_nothing_through_below():
    u = np.linspace(-4, 4, 801)
    q = values("dead_zone", threshold=1.5, corner_width=1e-6, negative_ratio=0.5)
    expected = np.where(u > 1.5, u - 1.5, np.where(u < -0.75, u + 0.75, 0.0))
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, q, DT), expected, atol=1e-5)
    steep = values("dead_zone", threshold=1.5, corner_width=1e-6, slope=2.0)
    expected = 2.0 * np.sign(u) * np.maximum(np.abs(u) - 1.5, 0.0)
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, steep, DT), expected, atol=1e-5)
    gated = values("dead_zone", threshold=1.5, gate=1.0, jump_width=1e-6)
    away = np.abs(np.abs(u) - 1.5) > 1e-3
    expected = np.where(np.abs(u) > 1.5, u, 0.0)
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, gated, DT)[away], expected[away])


def test_a_gate_opens_over_its_width_as_a_logistic_curve():
    u = np.linspace(0.5, 2.5, 401)
    gated = values("dead_zone", threshold=1.5, gate=1.0, jump_width=0.2)
    passed = catalogue()["dead_zone"].shape_input(u, gated, DT) / u
    np.testing.assert_allclose(passed, 0.5 + 0.5 * np.tanh((u - 1.5) / 0.2), atol=1e-9)


def test_beyond_its_threshold_a_dead_zone_may_flow_as_a_power_or_bend():
    """Above a yield stress a flow is a power of the excess; a valve's pressure rises with it."""
    u = np.linspace(-4, 4, 801)
    law, peak = catalogue()["dead_zone"].shape_input, SCALES.u_peak
    excess = np.maximum(np.abs(u) - 1.5, 0.0) / peak
    power = values("dead_zone", threshold=1.5, corner_width=1e-6, exponent=1.7)
    assert np.allclose(law(u, power, DT), np.sign(u) * peak * excess**1.7, atol=1e-5)
    bent = values("dead_zone", threshold=1.5, corner_width=1e-6, bend=0.4)
    expected = np.sign(u) * peak * (excess + 0.4 * excess**2)
    assert np.allclose(law(u, bent, DT), expected, atol=1e-5)


@pytest.mark.parametrize(("low", "high"), [(1.1, 3.75), (0.0, 5.0), (-2.0, 4.0)])
def test_the_largest_input_passes_a_dead_zone_unchanged_wherever_its_fit_starts(low, high):
    effect, scales = catalogue()["dead_zone"], replace(SCALES, u_low=low, u_high=high)
    thresholds = [start[0] for start in effect.starts(scales)]
    assert (np.array(thresholds) > max(low, 0.0)).all()
    assert (np.array(thresholds) < high).all()
    for start in effect.starts(scales):
        passed = effect.shape_input(np.array([high]), np.array(start), DT)
        np.testing.assert_allclose(passed, high, rtol=1e-6)


@pytest.mark.parametrize("name", ["dead_zone", "input_saturation"])
def test_a_law_has_a_negative_side_of_its_own_where_the_input_goes_there(name):
    for low, free in ((1.1, False), (-1.1, True)):
        told = catalogue()[name].parameters(replace(SCALES, u_low=low))
        [ratio] = [each for each in told if each.name == "negative_ratio"]
        assert (ratio.nominal, ratio.spread > 0.0) == (1.0, free)


@pytest.mark.parametrize("exponent", [0.4, 1.0, 3.0])
@pytest.mark.parametrize("bend", [-0.28, 5.0])
def test_a_dead_zone_never_falls(exponent, bend):
    """Otherwise it would be a sensor that folds."""
    [lowest] = [p.low for p in catalogue()["dead_zone"].parameters(SCALES) if p.name == "bend"]
    u = np.linspace(-1, 1, 2001) * SCALES.u_peak
    q = values("dead_zone", threshold=0.0, exponent=exponent, bend=max(bend, lowest))
    assert lowest == -0.28
    assert np.diff(catalogue()["dead_zone"].shape_input(u, q, DT)).min() >= 0.0


def test_sharp_saturations_clip_and_soft_ones_follow_their_formula():
    q = values("input_saturation", limit=2.5, sharpness=200.0)
    found = catalogue()["input_saturation"].shape_input(U, q, DT)
    assert np.allclose(found, np.clip(U, -2.5, 2.5), atol=0.01)
    q = values("input_saturation", limit=2.5, sharpness=3.0, remaining_slope=0.2)
    soft = U / (1 + (U / 2.5) ** 3) ** (1 / 3)
    found = catalogue()["input_saturation"].shape_input(U, q, DT)
    assert np.allclose(found, 0.8 * soft + 0.2 * U)
    q = values("output_saturation", upper_end=1.0, lower_end=0.5, sharpness=200.0, middle=0.8)
    law = catalogue()["output_saturation"].shape_output
    assert np.allclose(law(Y, T, q, DT), np.clip(Y, 0.5, 1.0), atol=2e-3)


@pytest.mark.parametrize(("slope", "limits"), [(0.1, True), (0.4, False)])
def test_a_bend_that_passes_most_of_what_comes_is_no_limit(slope, limits):
    u = np.linspace(0.0, SCALES.u_peak, 200)
    knee = 0.5 * SCALES.u_peak
    bent = np.where(u < knee, u, knee + slope * (u - knee))
    effect = catalogue()["input_saturation"]
    limit, sharpness, remaining = effect.parameters(SCALES)[:3]
    low, high = zip(*((p.low, p.high) for p in (limit, sharpness, remaining)), strict=True)
    fitted = least_squares(
        lambda q: effect.shape_input(u, np.array([*q, 1.0, 0.0]), DT) - bent,
        [knee, 30.0, 0.05], bounds=(low, high), x_scale=[knee, 30.0, 0.1],
    )  # fmt: skip
    left = np.sqrt(np.mean(fitted.fun**2)) / SCALES.u_peak
    assert bool(left < 0.003) is limits


def test_slew_limit_without_lag_is_a_rate_limiter():
    steps = np.repeat([1.0, 3.0, 0.5], 100)
    q = values("slew_limit", rate=2.0, falling_ratio=0.5, lag=1e-9)
    v = catalogue()["slew_limit"].shape_input(steps, q, DT)
    # Up 2 V at 2 V/s takes one second, down 2.5 V at 1 V/s two and a half.
    assert v[100 + 25] == pytest.approx(1.0 + 25.5 * DT * 2.0, rel=1e-6)
    assert v[100 + 60] == pytest.approx(3.0)
    assert v[200 + 50] == pytest.approx(3.0 - 50.5 * DT * 1.0, rel=1e-6)


@pytest.mark.parametrize("sharpness", [1.0, 2.0])
def test_a_soft_rate_limit_saturates_as_its_formula_says(sharpness):
    """At one the rate is half its limit where the error is the limit times the lag."""
    steps, tau, rate = np.repeat([1.0, 3.0, 0.5], 80), 0.1, 2.0
    q = values("slew_limit", rate=rate, falling_ratio=0.5, lag=tau, sharpness=sharpness)
    found = catalogue()["slew_limit"].shape_input(steps, q, DT)

    def speed(t, v, target):
        asked = (target - v[0]) / tau
        most = rate if asked > 0.0 else 0.5 * rate
        return [asked / (1.0 + abs(asked / most) ** sharpness) ** (1.0 / sharpness)]

    v, times = 1.0, DT * np.append(np.arange(80) + 0.5, 80.0)
    for first, target in ((80, 3.0), (160, 0.5)):
        course = solve_ivp(speed, (0.0, 80 * DT), [v], args=(target,), t_eval=times, rtol=1e-9)
        *expected, v = course.y[0]
        np.testing.assert_allclose(found[first : first + 80], expected, atol=0.02)


def test_rates_that_grow_with_the_level_rise_and_fall_exponentially():
    """From v the distance to where the rate would be zero grows by exp(growth rate t / half)."""
    middle, half = 2.0, 1.0
    steps = np.repeat([1.2, 2.9, 1.1], [50, 120, 250])
    q = values("slew_limit", rate=1.0, falling_ratio=0.5, lag=1e-9, middle=middle, half_range=half,
               rise_growth=-0.5, fall_growth=0.4)  # fmt: skip
    found = catalogue()["slew_limit"].shape_input(steps, q, DT)

    def course(start, rate, growth, t):
        zero = middle - half / growth
        return zero + (start - zero) * np.exp(rate * growth / half * t)

    rising, falling = course(1.2, 1.0, -0.5, 50.5 * DT), course(2.9, -0.5, 0.4, 50.5 * DT)
    assert (found[100], found[220]) == pytest.approx((rising, falling), rel=2e-3)
    assert found[169] == pytest.approx(2.9)


def test_a_speed_that_lags_solves_its_differential_equation():
    steps = np.repeat([1.0, 3.0, 0.5], 80)
    rate, tau, inertia = 2.0, 0.1, 0.3
    q = values("slew_limit", rate=rate, falling_ratio=0.5, lag=tau, speed_lag=inertia)
    found = catalogue()["slew_limit"].shape_input(steps, q, DT)
    fine = 500
    v, speed, expected = steps[0], 0.0, []
    for u in steps:
        course = []
        for _ in range(fine):
            course.append(v)
            wanted = np.clip((u - v) / tau, -0.5 * rate, rate)
            v, speed = v + DT / fine * speed, speed + DT / fine * (wanted - speed) / inertia
        expected.append(np.mean(course))
    assert np.ptp(found) > 1.5
    assert np.allclose(found, expected, atol=0.02)


@pytest.mark.parametrize("ratio", [0.1, 0.2, 0.5, 1.0, 4.0])
def test_a_speed_that_lags_long_passes_the_target(ratio):
    """Below its limit it is an oscillator with a damping ratio of half the root of 1 / ratio."""
    tau, step = 50 * DT, np.repeat([0.0, 1.0], [10, 1500])
    q = values("slew_limit", rate=1e6, falling_ratio=1.0, lag=tau, speed_lag=ratio * tau)
    found = catalogue()["slew_limit"].shape_input(step, q, DT)
    damping = 0.5 / np.sqrt(ratio)
    overshoot = np.exp(-np.pi * damping / np.sqrt(1 - damping**2)) if damping < 1.0 else 0.0
    assert found.max() - 1.0 == pytest.approx(overshoot, abs=0.01)


def test_transport_delay_is_linear_interpolation():
    q = values("transport_delay", delay=3.4 * DT)
    delayed = catalogue()["transport_delay"].shape_input(U, q, DT)
    expected = np.interp(T - 3.4 * DT, T, U)
    assert np.allclose(delayed[5:], expected[5:])


@pytest.mark.parametrize("samples", [0.25, 3.0, 7.5])
def test_a_smooth_input_is_delayed_as_its_spectrum_says(samples):
    effect = catalogue()["transport_delay"]
    q = values("transport_delay", delay=samples * DT, smooth=1.0)
    for frequency, error in ((2.0, 0.001), (7.0, 0.05)):
        phase = 2 * np.pi * frequency * T + 0.3
        exact = np.sin(phase - 2 * np.pi * frequency * samples * DT)
        found = effect.shape_input(np.sin(phase), q, DT)
        straight = effect.shape_input(np.sin(phase), np.r_[q[:-1], 0.0], DT)
        off, by_lines = (np.abs(each - exact)[12:-2].max() for each in (found, straight))
        assert off < error
        assert samples % 1 == 0 or off < 0.5 * by_lines


def test_a_spread_delay_keeps_its_mean_and_deviates_by_its_spread():
    pulse = np.zeros(4000)
    pulse[10] = 1.0
    q = values("transport_delay", delay=60.3 * DT, spread=0.4)
    found = catalogue()["transport_delay"].shape_input(pulse, q, DT)
    after = np.arange(4000) - 10
    assert found.sum() == pytest.approx(1.0)
    assert found @ after == pytest.approx(60.3)
    assert np.sqrt(found @ (after - 60.3) ** 2) == pytest.approx(0.4 * 60.3, rel=1e-3)
    assert not found[after < 36].any()


def test_streams_of_unequal_speed_arrive_one_after_the_other():
    """A laminar flow is a bundle of pure delays: the last part q of it after (1 - q)^(-1/2) d."""
    effect, delay = catalogue()["transport_delay"], 20.3 * DT
    q = values("transport_delay", delay=delay, spread=0.5, streams=1.0)
    first, parts = 0.5 * delay, (np.arange(3000) + 0.5) / 3000
    times = first / np.sqrt(1.0 - parts)
    assert times.mean() == pytest.approx(delay, rel=0.02)
    one_by_one = [
        effect.shape_input(U[:300], values("transport_delay", delay=time), DT) for time in times
    ]
    found = effect.shape_input(U[:300], q, DT)
    np.testing.assert_allclose(found, np.mean(one_by_one, axis=0), atol=2e-3 * np.ptp(U))


def test_a_wave_that_is_reflected_arrives_again_after_three_times_as_long():
    """The delay is that of the first arrival."""
    pulse = np.zeros(400)
    pulse[10] = 1.0
    q = values("transport_delay", delay=20 * DT, echo=-0.1)
    found = catalogue()["transport_delay"].shape_input(pulse, q, DT)
    expected = np.zeros(400)
    expected[[30, 70]] = 1.1, -0.1
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_streams_that_hardly_differ_delay_a_smooth_input_as_a_pure_delay_does():
    effect, signal = catalogue()["transport_delay"], np.sin(2 * np.pi * 8.0 * T)
    shared = {"delay": 6.3 * DT, "streams": 1.0, "smooth": 1.0}
    sharp = effect.shape_input(signal, values("transport_delay", **shared), DT)
    spread = effect.shape_input(signal, values("transport_delay", spread=1e-6, **shared), DT)
    np.testing.assert_allclose(spread[20:], sharp[20:], atol=1e-4)


def test_electrode_lag_solves_its_differential_equation():
    tau, fine = 0.13, 200
    # With a near part of the ratio of its lags it is a single lag.
    q = values("electrode_lag", time_constant=tau, fast_ratio=1e-3, near_weight=1e-3)
    law = catalogue()["electrode_lag"].shape_input
    mean = law(U, q, DT)
    v, expected = U[0], []
    for u in U[:300]:
        total = 0.0
        for _ in range(fine):
            before = v
            v += DT / fine * (u - v) / tau
            total += 0.5 * (before + v)
        expected.append(total / fine)
    assert np.allclose(mean[:300], expected, atol=2e-3)
    held = np.full(100, 2.0)
    charged = law(held, values("electrode_lag", time_constant=tau, start_charge=-0.5), DT)
    t = (np.arange(100) + 0.5) * DT
    assert np.allclose(charged, 2.0 - 0.9 * 0.5 * np.exp(-t / tau), atol=2e-3)


@pytest.mark.parametrize("order", [1.5, 2.5])
def test_the_far_charge_may_approach_with_a_power_of_its_distance(order):
    tau, full = 0.13, SCALES.u_peak
    q = values("electrode_lag", time_constant=tau, fast_ratio=1e-3, near_weight=0.0, order=order)
    found = catalogue()["electrode_lag"].shape_input(U[:200], q, DT)
    fine, v, expected = 400, U[0], []
    for u in U[:200]:
        path = [v]
        for _ in range(fine):
            away = (u - v) / full
            v += DT / fine * full / tau * np.sign(away) * abs(away) ** order
            path.append(v)
        expected.append(np.mean(path))
    np.testing.assert_allclose(found, expected, atol=4e-3)


@pytest.mark.parametrize("part", [0.0, 0.3, 0.5])
def test_electrode_lag_is_a_ladder_of_two_lags(part):
    slow, fast, step = 0.9, 0.36, np.ones(1000)
    step[0] = 0.0
    q = values("electrode_lag", time_constant=slow, fast_ratio=fast / slow, near_weight=part)
    found = catalogue()["electrode_lag"].shape_input(step, q, DT)
    t = (np.arange(1000) - 0.5) * DT
    system = lti(np.trim_zeros([part * slow, 1.0], "f"), np.polymul([slow, 1.0], [fast, 1.0]))
    _, expected = system.step(T=np.arange(0.0, 20.0, 0.1 * DT))
    expected = np.interp(t, np.arange(0.0, 20.0, 0.1 * DT), expected)
    assert np.abs(found - expected)[2:].max() < 0.01
    if part == 0.5:
        # More of a near part than the lags' ratio: two lags in parallel.
        parallel = 1.0 - (5 / 6) * np.exp(-t / slow) - (1 / 6) * np.exp(-t / fast)
        assert np.abs(expected - parallel)[2:].max() < 1e-3


@pytest.mark.parametrize(
    "polynomial",
    [
        (3.0, 1.0),
        (0.1, 1.0),
        (4.0, 2.0, 1.0),
        (0.25, 1.0, 1.0),
        (100.0, 30.0, 1.0),
        (50.0, 1.0, 1.0),
    ],
)
def test_low_pass_is_that_of_a_signal_straight_between_samples(polynomial):
    found = low_pass(Y, polynomial)
    numerator, denominator, _ = cont2discrete(([1.0], polynomial), 1.0, method="foh")
    start = Y[0] * lfilter_zi(numerator.ravel(), denominator)
    expected, _ = lfilter(numerator.ravel(), denominator, Y, zi=start)
    assert np.allclose(found, expected, rtol=1e-11)


@pytest.mark.parametrize("damping", [0.3, 1.0, 5.0])
def test_sensor_lag_has_the_frequency_response_of_second_order(damping):
    tau, omega = 0.3, 2 * np.pi * 0.23
    q = values("sensor_lag", time_constant=tau, damping=damping)
    smooth = catalogue()["sensor_lag"].shape_output(Y, T, q, DT)
    natural = 2.0 * damping / tau
    gain = 1.0 / (1.0 - (omega / natural) ** 2 + 1j * omega * tau)
    expected = 0.8 + 0.4 * np.imag(gain * np.exp(1j * omega * T))
    assert np.allclose(smooth[1000:], expected[1000:], atol=2e-4)


@pytest.mark.parametrize(("order", "part"), [(1.25, 0.0), (1.5, 0.4), (3.0, 0.0)])
def test_a_sensor_may_be_the_slower_the_smaller_its_error_is(order, part):
    """Natural convection: the error e obeys de/dt = dy/dt - e |e / full|^(order - 1) / time."""
    tau, full = 0.3, 0.5 * SCALES.y_span
    q = values("sensor_lag", time_constant=tau, damping=5.0, fast_part=part, order=order)
    y = SCALES.y_middle + full * np.sin(2.0 * np.pi * 0.4 * T)
    read = catalogue()["sensor_lag"].shape_output(y, T, q, DT)
    linear = q.copy()
    names = [each.name for each in catalogue()["sensor_lag"].parameters(SCALES)]
    linear[names.index("order")] = 1.0
    beyond = read - catalogue()["sensor_lag"].shape_output(y, T, linear, DT)

    def rate(t, r, power):
        error = np.interp(t, T, y) - r
        return error * (np.abs(error) / full) ** (power - 1.0) / tau

    exact = [
        solve_ivp(rate, (0.0, T[-1]), [y[0]], args=(power,), t_eval=T, rtol=1e-9, atol=1e-12,
                  max_step=DT).y[0]
        for power in (order, 1.0)
    ]  # fmt: skip
    np.testing.assert_allclose(beyond, (1.0 - part) * (exact[0] - exact[1]), atol=2e-3 * full)


def test_a_part_of_a_sensor_lag_may_be_faster():
    tau, omega, part = 0.3, 2 * np.pi * 0.23, 0.4
    q = values("sensor_lag", time_constant=tau, damping=1.0, fast_part=part)
    smooth = catalogue()["sensor_lag"].shape_output(Y, T, q, DT)
    slow = 1.0 / (1.0 - (0.5 * omega * tau) ** 2 + 1j * omega * tau)
    gain = (1.0 - part) * slow + part / (1.0 + 0.15j * omega * tau)
    expected = 0.8 + 0.4 * np.imag(gain * np.exp(1j * omega * T))
    assert np.allclose(smooth[1000:], expected[1000:], atol=2e-4)


@pytest.mark.parametrize(
    ("slow", "equal", "ringing", "worst"),
    [
        (0.25, 1.0, 0.235, 0.005), (0.25, 1.0, 1.78, 0.02), (0.25, 0.4, 0.914, 0.01),
        (0.04, 0.1, 0.5, 0.05), (0.02, 0.1, 3.0, 0.1), (0.002, 0.1, 3.0, 0.02),
    ],
)  # fmt: skip
def test_electrodes_ring_as_a_series_circuit_with_an_inductance(slow, equal, ringing, worst):
    """Against its matrix exponential, at means over intervals of a held input."""
    fast = equal * slow
    square = (1.0 + ringing) / (slow * fast)
    A = np.array([[0.0, 1.0], [-square, -(slow + fast) / (slow * fast)]])
    fine = 40
    whole = np.zeros((3, 3))
    whole[:2, :2], whole[1, 2] = A, square
    step = expm(whole * DT / fine)
    held = np.repeat(np.random.default_rng(4).uniform(0.5, 2.0, 40), 25)
    x, expected = np.array([held[0], 0.0]), []
    for u in held:
        path = [x]
        for _ in range(fine):
            path.append(step[:2, :2] @ path[-1] + step[:2, 2] * u)
        x = path[-1]
        expected.append(np.mean([0.5 * (a[0] + b[0]) for a, b in pairwise(path)]))
    q = values(
        "electrode_lag", time_constant=slow, fast_ratio=equal, near_weight=0.0, ringing=ringing
    )
    found = catalogue()["electrode_lag"].shape_input(held, q, DT)
    assert np.abs(found - expected).max() < worst * np.ptp(held)


def test_an_electrode_may_discharge_more_slowly_than_it_charges():
    """Against an integrator of another kind, at the ends of the intervals."""
    tau, falling = 0.3, 3.0
    u = np.repeat([1.0, 2.5, 0.5, 2.0], 100)
    q = values(
        "electrode_lag", time_constant=tau, fast_ratio=1e-3, near_weight=0.0, falling_ratio=falling
    )
    found = catalogue()["electrode_lag"].shape_input(u, q, DT)
    level, ends = 1.0, [1.0]
    for target in (1.0, 2.5, 0.5, 2.0):
        times = DT * np.arange(1, 101)
        path = solve_ivp(
            lambda t, v, at=target: (at - v) / (tau if v[0] < at else tau * falling),
            (0.0, times[-1]), [level], t_eval=times, rtol=1e-9, atol=1e-12,
        ).y[0]  # fmt: skip
        level = path[-1]
        ends += path.tolist()
    middles = 0.5 * (np.array(ends[1:]) + np.array(ends[:-1]))
    away = np.arange(u.size) % 100 > 2
    assert np.allclose(found[away], middles[away], atol=2e-3)


@pytest.mark.parametrize("ageing", [-1.8, 1.0])
def test_electrodes_that_dry_lag_more_and_more(ageing):
    """Against an integrator of another kind, on the means of the intervals; then as at the end."""
    tau, size = 0.05, 320
    duration = 0.4 * size * DT
    q = values(
        "electrode_lag", time_constant=tau, fast_ratio=1e-3, near_weight=0.0,
        ageing=ageing, duration=duration,
    )  # fmt: skip
    u = np.tile(np.repeat([1.0, 2.5, 0.5, 2.0], 10), size // 40)
    found = catalogue()["electrode_lag"].shape_input(u, q, DT)

    def lag(t):
        return tau * (1.0 + ageing * (min(t / duration, 1.0) - 0.5))

    level, area = [1.0, 0.0], [0.0]
    for k in range(size):
        path = solve_ivp(
            lambda t, v, at=u[k]: ((at - v[0]) / lag(t), v[0]), (k * DT, (k + 1) * DT), level,
            rtol=1e-9, atol=1e-12,
        )  # fmt: skip
        level = path.y[:, -1]
        area.append(level[1])
    assert np.abs(found - np.diff(area) / DT).max() < 5e-3


def test_a_sensor_that_lags_is_at_rest_before_the_record():
    q = values("sensor_lag", time_constant=0.3, damping=0.3, delay_ratio=0.5)
    smooth = catalogue()["sensor_lag"].shape_output(np.full(T.size, 0.8), T, q, DT)
    assert np.allclose(smooth, 0.8, rtol=1e-9)


@pytest.mark.parametrize(("growth", "quickening"), [(0.0, 0.0), (2.0, 0.0), (2.0, 1.5)])
def test_charge_leakage_solves_its_differential_equation(growth, quickening):
    loss, tau, part, fine = 0.3, 2.0, 0.4, 200
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=tau, start_part=part,
        full_field=4.0, quickening=quickening,
    )  # fmt: skip

    def speed(field):
        return np.exp(quickening * abs(field) / 4.0) / (tau * (1.0 + loss))

    def target(field):
        return loss * np.exp(growth * (abs(field) / 4.0 - 1.0)) * field

    # At the start the part of what is lost in the end, as far as the loss does not grow on the way.
    whole = target(U[0]) / U[0]
    lost, expected = part * U[0] * whole / (1.0 + whole), []
    for u in U:
        total = 0.0
        for _ in range(fine):
            before = lost
            lost += DT / fine * (target(u - lost) - lost) * speed(u - lost)
            total += u - 0.5 * (before + lost)
        expected.append(total / fine)
    assert np.allclose(catalogue()["charge_leakage"].shape_input(U, q, DT), expected, atol=5e-3)


@pytest.mark.parametrize("quickening", [0.0, 2.0])
def test_half_the_interval_leaves_a_quarter_of_the_error_of_a_leaking_charge(quickening):
    loss, growth, tau, peak, interval = 0.5, 4.0, 1.0, 3.0, 0.1
    u = 0.3 + 3.0 * np.sin(0.15 * np.arange(80))
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=tau, start_part=0.5,
        full_field=peak, quickening=quickening,
    )  # fmt: skip

    def slope(_, x, level):
        field = level - x[0]
        target = loss * np.exp(growth * (abs(field) / peak - 1.0)) * field
        speed = np.exp(quickening * abs(field) / peak) / (tau * (1.0 + loss))
        return [(target - x[0]) * speed, field]

    whole = loss * np.exp(growth * (u[0] / peak - 1.0))
    lost, expected = 0.5 * whole / (1.0 + whole) * u[0], []
    for level in u:
        solved = solve_ivp(
            slope, (0, interval), [lost, 0.0], "LSODA", args=(level,), rtol=1e-9, atol=1e-11
        )
        lost, area = solved.y[:, -1]
        expected.append(area / interval)
    errors = []
    for parts in (1, 2, 4):
        found = catalogue()["charge_leakage"].shape_input(np.repeat(u, parts), q, interval / parts)
        errors.append(np.std(found.reshape(-1, parts).mean(1) - expected))
    assert errors[0] < 5e-3
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.15)


@pytest.mark.parametrize("level", [1.0, 3.0, -3.0])
@pytest.mark.parametrize("start_part", [0.0, 2.0])
@pytest.mark.parametrize(("growth", "quickening"), [(9.0, 6.0), (20.0, 8.0), (20.0, 0.0)])
def test_a_leaking_charge_settles_under_a_held_input(growth, quickening, start_part, level):
    """The shortest time constant and the largest loss: the field settles where the loss stays."""
    loss, peak, u = 0.9, 3.0, np.full(2000, level)
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=10 * DT, full_field=peak,
        start_part=start_part, quickening=quickening,
    )  # fmt: skip
    settled = brentq(
        lambda field: field + loss * np.exp(growth * (field / peak - 1.0)) * field - abs(level),
        0.0, abs(level), xtol=1e-12,
    )  # fmt: skip
    found = catalogue()["charge_leakage"].shape_input(u, q, DT)
    np.testing.assert_allclose(found[-200:], np.sign(level) * settled, rtol=1e-9)


@pytest.mark.parametrize("tau", [0.5, 3.0])
def test_a_charge_that_leaks_as_a_whole_is_a_high_pass_filter(tau):
    q = values(
        "charge_leakage", loss=1e3, field_growth=0.0, settling_time=tau, start_part=1.0
    )  # fmt: skip
    found = catalogue()["charge_leakage"].shape_input(U, q, DT)
    # Over a step at a held input, the mean of what a capacitor in series leaves.
    after, decay = [], np.exp(-DT / tau)
    charge = U[0]
    for u in U:
        after.append((u - charge) * tau / DT * (1.0 - decay))
        charge = u + (charge - u) * decay
    np.testing.assert_allclose(found, after, atol=3e-3 * np.ptp(U))
    lost, settling = catalogue()["charge_leakage"].quantities
    assert lost.of(q, SCALES) == pytest.approx(1000.0 / 1001.0)
    assert settling.of(q, SCALES) == tau


# Moduli of a creep's branches over the first one's 0.05, and what the film has gone through.
BRANCHES = (1.0, 0.4, 3.0, 0.1, 0.7, 2.0, 0.05, 1.5)
HISTORY = {"start_position": 0.3, "stretch": 2.0, "age": 9.0}


def creep(**changed):
    """The parameters of a creep, and the moduli and times of its branches."""
    own = {f"branch_{i}": np.log(k) for i, k in enumerate(BRANCHES, 1)}
    q = values("viscoelastic_creep", stiffness=0.05, branch_ratio=0.8, **own, **changed)
    return q, 0.05 * np.array(BRANCHES) * 0.8 ** np.arange(8), np.geomspace(2 * DT, 80.0, 8)


@pytest.mark.parametrize("tilt", [-1.0, -0.9, 0.9, 1.0])
@pytest.mark.parametrize("duhem", [0.0, 1.0])
def test_hysteresis_beyond_the_range_of_a_record_never_drives_the_motion(tilt, duhem):
    """A designed excitation may move the device to where loops that shrink have vanished."""
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.3, tilt=tilt, middle=0.0,
        half_range=1.0, start_position=-2.0, duhem_part=duhem,
    )  # fmt: skip
    swing = 0.2 * np.sin(2.0 * np.pi * np.arange(2001) / 500)
    work = []
    for place in np.linspace(-1.8, 1.8, 13):
        path = place + swing
        found = forces("rate_independent_hysteresis", q, path)[-501:]
        middle = 0.5 * (found[1:] + found[:-1])
        work.append(-np.sum(middle * np.diff(path[-501:])))
    assert min(work) >= -1e-12
    assert max(work) > 0.01


@pytest.mark.parametrize("exponent", [0.0, 1.0, -0.6])
def test_creep_follows_the_equations_of_a_generalised_maxwell_body(exponent):
    """With dashpots that flow as a power of the stress (Norton) from a stretch on."""
    q, stiffness, tau = creep(
        tilt=0.6, curve=-0.4, rate_exponent=exponent, rate_stretch=0.3, **HISTORY
    )

    def place(t):
        return 0.9 * np.sin(1.3 * t) * np.cos(0.4 * t)

    def strain(x):
        return x - 0.4 * x**2 / (1 + abs(x))

    def rest(t, dashpots):
        return (0.3 - dashpots) / tau

    def flow(t, dashpots):
        branches = strain(place(t)) - dashpots
        stretch = stiffness @ branches / stiffness.sum()
        return branches / tau * (1 + (stretch / 0.3) ** 2) ** exponent

    # Stretched by 2 and then held for 9 s, before it moves.
    before = solve_ivp(rest, (-9, 0), np.full(8, 0.3 - 2.0), method="LSODA", rtol=1e-9)
    h = 1e-3
    t = np.arange(8000) * h
    solved = solve_ivp(
        flow, (0, t[-1]), before.y[:, -1], t_eval=t, method="LSODA", rtol=1e-9, atol=1e-11
    )
    stress = stiffness @ (strain(place(t)) - solved.y)
    grown = 0.6 * place(t) + np.sqrt(1 + (0.6 * place(t)) ** 2)
    found = forces("viscoelastic_creep", q, 0.7 + 0.3 * place(t), h)
    error = found + 0.3 * (grown * stress)[:-1]
    assert np.abs(error).max() < 0.01 * np.abs(found).max()


def test_creep_relaxes_as_a_prony_series():
    q, stiffness, tau = creep()
    # At rest in the middle, then held at the end of the range.
    found = forces("viscoelastic_creep", q, np.r_[0.7, np.full(1999, 1.0)])[1:]
    after = np.arange(1998) * DT
    expected = -0.3 * np.exp(-after[:, None] / tau) @ (stiffness * np.exp(-DT / tau))
    assert np.allclose(found, expected, rtol=1e-9)


def test_what_a_creep_amounts_to_is_what_its_force_loses_after_a_step():
    """From when the motion has crossed its range, and the time at which half of that is lost."""
    q, *_ = creep(curve=0.5)
    h, step = 1e-3, 1e-3
    # A small step from the middle, about which the law is as at rest.
    held = np.full(round(SCALES.duration / h) + 1, 0.7 + step)
    force = forces("viscoelastic_creep", q, np.r_[0.7, held], h)[1:]
    after = (SCALES.z_high - SCALES.z_low) / SCALES.z_rate
    lost = force[round(after / h) :] - force[round(after / h)]
    stiffness, half_time = catalogue()["viscoelastic_creep"].quantities
    assert stiffness.of(q, SCALES) == pytest.approx(lost[-1] / step, rel=0.02)
    expected = after + np.interp(0.5 * lost[-1], lost, h * np.arange(lost.size))
    assert half_time.of(q, SCALES) == pytest.approx(expected, rel=0.02)


def test_a_stretched_film_relaxes_while_it_does_not_move():
    q, stiffness, tau = creep(stretch=2.0, age=9.0)
    expected = -0.3 * np.exp(-(9.0 + T[:-1, None]) / tau) @ (2.0 * stiffness)
    assert np.allclose(forces("viscoelastic_creep", q, np.full(T.size, 0.7)), expected, rtol=1e-9)


def test_creep_that_does_not_respond_to_the_motion_relaxes_as_if_there_were_none():
    q, stiffness, tau = creep(response=0.0, stretch=2.0, age=9.0)
    expected = -0.3 * np.exp(-(9.0 + T[:-1, None]) / tau) @ (2.0 * stiffness)
    assert np.allclose(forces("viscoelastic_creep", q), expected, rtol=1e-9)


def test_hysteresis_is_rate_independent_and_keeps_return_point_memory():
    q = values("rate_independent_hysteresis", stiffness=0.4, largest_radius=0.3, weight_decay=0.5)
    path = np.concatenate(
        [np.linspace(a, b, 200) for a, b in ((0.7, 1.0), (1.0, 0.4), (0.4, 0.8), (0.8, 0.4))]
    )
    slow = forces("rate_independent_hysteresis", q, path)
    fast = forces("rate_independent_hysteresis", q, path[::4])
    assert np.allclose(slow[::4][: fast.size], fast, atol=2e-3)
    # Back where the inner loop was left, the force is what it was there.
    assert slow[-1] == pytest.approx(slow[398], abs=2e-3)


def test_stops_equal_plays():
    """A stop is the motion less the play operator of the same radius."""
    q = values(
        "rate_independent_hysteresis",
        stiffness=1.0, largest_radius=0.2, weight_decay=1.5, start_position=0.7,
    )  # fmt: skip
    rank = np.arange(1, 12)
    radii, weights = 0.2 * (rank / 11) ** 2, rank * np.exp(-1.5 * rank / 11)
    play = np.full(11, 0.7)
    expected = []
    for z in Z[:-1]:
        play = np.minimum(np.maximum(play, z - radii), z + radii)
        expected.append(-weights @ (z - play) / 11)
    assert np.allclose(forces("rate_independent_hysteresis", q)[1:], expected[1:], atol=1e-12)


def test_slipping_stops_pull_harder_where_they_have_grown():
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, weight_decay=1.5,
        start_position=0.0, tilt=0.4, growth_at_ends=0.3, middle=0.5, half_range=0.5,
    )  # fmt: skip
    path = np.linspace(0.0, 1.0, 4001)
    found = forces("rate_independent_hysteresis", q, path)
    place = (path[2000:-1] - 0.5) / 0.5
    rank = np.arange(1, 12)
    slipping = np.sum(rank * np.exp(-1.5 * rank / 11) * 0.2 * (rank / 11) ** 2) / 11
    expected = -slipping * (1.0 + 0.4 * place + 0.3 * place**2)
    assert np.allclose(found[2000:], expected, rtol=1e-3)


def test_stops_that_have_shrunk_to_nothing_have_no_force():
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, tilt=-0.5, skew=0.3,
        middle=0.0, half_range=0.5,
    )  # fmt: skip
    found = forces("rate_independent_hysteresis", q, np.linspace(0.0, 2.0, 401))
    assert np.isfinite(found).all()
    assert np.allclose(found[201:], 0.0)


def test_skewed_stops_pull_harder_at_their_upper_limit():
    """Up and down, each stop that has slipped pulls by 1.3 and 0.7 of its limit."""
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, weight_decay=1.5,
        start_position=0.0, skew=0.3,
    )  # fmt: skip
    path = np.concatenate([np.linspace(0.0, 1.0, 1001), np.linspace(1.0, 0.0, 1001)])
    found = forces("rate_independent_hysteresis", q, path)
    rank = np.arange(1, 12)
    slipping = np.sum(rank * np.exp(-1.5 * rank / 11) * 0.2 * (rank / 11) ** 2) / 11
    assert np.allclose(found[500:1000], -1.3 * slipping)
    assert np.allclose(found[-500:], 0.7 * slipping)


def test_loops_may_be_smaller_where_the_material_saturates():
    """Small loops at the middle of the motion, and at its upper end a third as large."""
    own = {"stiffness": 0.2, "largest_radius": 0.05, "growth_at_ends": -2.0}
    q = values("rate_independent_hysteresis", **own)
    middle, half = 0.5 * (SCALES.z_low + SCALES.z_high), 0.5 * SCALES.z_span
    swing = 0.2 * half * np.sin(2 * np.pi * np.arange(2001) / 500)
    sizes = []
    for place in (middle, middle + half):
        found = forces("rate_independent_hysteresis", q, place + swing)[-501:]
        sizes.append(np.ptp(found))
    assert 0.25 < sizes[1] / sizes[0] < 0.45


def test_loops_of_duhem_follow_the_equation_of_coleman_and_hodgdon():
    """Their equation df = k dz - f |dz| / L, integrated through reversals of uneven size."""
    q = values(
        "rate_independent_hysteresis",
        stiffness=0.4, largest_radius=0.3, start_position=0.7, duhem_part=1.0,
    )  # fmt: skip
    turns = np.array([0.7, 1.0, 0.4, 0.8, 0.55, 0.95])
    found = forces("rate_independent_hysteresis", q, path_through(turns))[::200]
    expected, f = [0.0], 0.0
    for a, b in pairwise(turns):
        sign = np.sign(b - a)
        solved = solve_ivp(
            lambda _, y, sign=sign: 0.4 * sign - y / 0.3,
            (0.0, abs(b - a)), [f], rtol=1e-9, atol=1e-12,
        )  # fmt: skip
        f = float(solved.y[0, -1])
        expected.append(-f)
    assert found == pytest.approx(expected[: found.size], abs=1e-8)


def path_through(turns):
    """A path of 200 steps from each turn to the next."""
    return np.concatenate([[turns[0]], *(np.linspace(a, b, 201)[1:] for a, b in pairwise(turns))])


def test_a_sheared_film_rubs_with_its_speed_alone():
    q = values("coulomb_friction", force=0.1, sheared_part=1.0, shear_rate=0.4,
               stiction_excess=0.5, stribeck_rate=2.0)  # fmt: skip
    z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.1 * T)
    found, speed = forces("coulomb_friction", q, z), np.diff(z) / DT
    expected = -0.1 * np.tanh(speed / 0.4) * (1.0 + 0.5 / (1.0 + (speed / 2.0) ** 2))
    assert np.allclose(found, expected)


def test_coulomb_friction_opposes_the_motion_with_one_force():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005)
    z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.1 * T)
    found, velocity = forces("coulomb_friction", q, z)[100:], np.diff(z)[100:]
    fast = np.abs(velocity) > 0.3 * np.abs(velocity).max()
    assert np.allclose(found[fast], -0.1 * np.sign(velocity[fast]))


def test_friction_may_be_larger_one_way():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005, asymmetry=0.3)
    slipped = np.zeros(MEMORY)
    law = catalogue()["coulomb_friction"].force
    for part, expected in ((1.0, -0.13), (-1.0, 0.07), (0.5, -0.0575)):
        slipped[:2] = part, 0.7
        assert law(0.7, 0.1, slipped, q) == pytest.approx(expected)


def test_friction_may_grow_with_the_load():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005, load_growth=0.4)
    slipped, law = np.zeros(MEMORY), catalogue()["coulomb_friction"].force
    for place, expected in ((SCALES.z_low, 0.6), (SCALES.z_high, 1.4)):
        slipped[:2] = -1.0, place
        assert law(place, -0.1, slipped, q) == pytest.approx(0.1 * expected)


def test_friction_begins_with_the_deflection_at_the_start():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.01, start_deflection=-0.5)
    found = forces("coulomb_friction", q, np.linspace(0.3, 0.32, 21))
    assert np.allclose(found, -0.1 * np.minimum(-0.5 + np.arange(20) / 10, 1.0))


def test_friction_is_larger_the_slower_the_motion():
    """Stribeck's curve at creeping, at characteristic and at fast velocity."""
    own = {"force": 0.1, "slip_deflection": 0.005, "stiction_excess": 0.6, "stribeck_rate": 0.2}
    q = values("coulomb_friction", **own)
    slipped = np.zeros(MEMORY)
    slipped[:2] = 1.0, 0.7
    law = catalogue()["coulomb_friction"].force
    found = [law(0.7, w, slipped, q) for w in (1e-9, 0.2, -0.2, 1e9)]
    assert np.allclose(found, [-0.16, -0.13, -0.13, -0.1])
    # Before it slips the contact is a spring, which pulls back.
    slipped[0] = 0.0
    assert law(0.6975, 1e9, slipped, q) == pytest.approx(0.05)


def test_stiffening_is_a_power_law_and_a_smooth_curve():
    z = np.linspace(0.4, 1.0, 21)
    effect = catalogue()["strain_stiffening"]

    def found(z, **own):
        q = values("strain_stiffening", **own)
        return [effect.force(v, 0.0, effect.memory(q), q) for v in z]

    both_ways = np.linspace(-1, 1, 21)
    power = found(both_ways, stiffening=0.2, exponent=3.0)
    assert np.allclose(power, -0.2 * both_ways**3)
    modes = np.random.default_rng(3).uniform(-0.05, 0.05, STIFFNESS_MODES)
    bent = {"stiffening": 0.0, **{f"mode_{n + 1}": m for n, m in enumerate(modes)}}
    curve = found(z, **bent)
    pieces = STIFFNESS_MODES - 1
    knots = np.linspace(-1.0 - 6.0 / pieces, 1.0 + 6.0 / pieces, pieces + 7)
    weights = stiffness_modes()[0] @ modes
    spline = BSpline(knots, weights, 3)
    assert np.allclose(curve, -0.33 * spline((z - 0.7) / 0.33))
    beyond = found(np.array([0.2, 1.3]), **bent)
    ends = np.array([-1.0, 1.0])
    straight = spline(ends) + spline(ends, 1) * ((np.array([0.2, 1.3]) - 0.7) / 0.33 - ends)
    assert np.allclose(beyond, -0.33 * straight)


def test_a_bilinear_spring_is_nearly_a_smooth_curve():
    """A cable that goes taut within the motion: a power about rest fits it badly.

    The curve bends as its prior allows, with a stiffness that is measured to a thousandth.
    """
    z = np.linspace(0.4, 1.0, 201)
    taut = -2.0 * np.maximum(z - 0.75, 0.0)
    effect = catalogue()["strain_stiffening"]
    own = [p for p in effect.parameters(SCALES) if p.name.startswith("mode_")]

    def left(columns, spreads):
        X, prior = np.column_stack(columns), np.diag(1e-3 / np.array(spreads))
        weights = np.linalg.lstsq(np.vstack([X, prior]), np.r_[taut, 0.0 * prior[0]], rcond=None)[0]
        return (taut - X @ weights).std() / taut.std()

    free = [1e6, 1e6]
    straight = [z, np.ones(z.size)]
    power = min(left([*straight, z**n], [*free, 1e6]) for n in np.linspace(1.5, 15.0, 28))
    curve = [
        [effect.force(v, 0.0, effect.memory(q), q) for v in z]
        for q in (values("strain_stiffening", **{p.name: 1.0}) for p in own)
    ]
    assert left([*straight, *curve], [*free, *(p.spread for p in own)]) < 0.5 * power


def test_friction_that_is_elastic_nowhere_is_that_of_bristles():
    """Canudas de Wit et al. (1995) at one level of friction: b' = w - s |w| b / F, force s b."""
    level, largest, h = 0.1, 0.02, 1e-3

    def place(t):
        return 0.7 + 0.1 * np.sin(0.9 * t) * np.cos(0.17 * t)

    def speed(t):
        fast, slow = 0.9 * t, 0.17 * t
        return 0.09 * np.cos(fast) * np.cos(slow) - 0.017 * np.sin(fast) * np.sin(slow)

    t = np.arange(20_000) * h
    bristle = solve_ivp(
        lambda t, b: speed(t) - abs(speed(t)) * b / largest,
        (0, t[-1]), [0.0], t_eval=t, method="LSODA", rtol=1e-9, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    q = values(
        "coulomb_friction", force=level, slip_deflection=0.5 * largest, elastic_part=-1.0,
    )  # fmt: skip
    expected = -level / largest * bristle.y[0, :-1]
    assert np.abs(forces("coulomb_friction", q, place(t), h) - expected).max() < 1e-3 * level


def test_a_contact_is_elastic_up_to_a_part_of_its_largest_deflection():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.02, elastic_part=0.4)
    found = forces("coulomb_friction", q, np.linspace(0.0, 0.05, 51))
    way = np.linspace(0.0, 0.05, 51)[:-1] / 0.02
    expected = np.where(way < 0.4, way, 1 - 0.6 * np.exp(-(way - 0.4) / 0.6))
    assert np.allclose(found, -0.1 * expected)


def test_softening_grows_with_the_way_and_not_with_time():
    q = values("cyclic_softening", softening=0.3, travel=2.0, exponent=1.0)
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(Z)))])[:-1]
    expected = 0.3 * (1 - np.exp(-way / 2.0)) * Z[:-1]
    assert np.allclose(forces("cyclic_softening", q), expected)
    resting = forces("cyclic_softening", q, np.full(100, 0.7))
    assert np.allclose(resting, 0.0)
    law = catalogue()["cyclic_softening"]
    q = values("cyclic_softening", softening=0.3, travel=2.0, exponent=0.5)
    for way, exponent in ((0.5, 0.5), (2.0, 1.0), (8.0, 2.0)):
        law.update(0.7, 0.7 + way, 1.0, travelled := np.zeros(MEMORY), q)
        assert law.force(0.7, 0.0, travelled, q) == pytest.approx(0.21 * (1 - np.exp(-exponent)))


def test_below_its_largest_stroke_a_material_is_softer_by_the_energy_it_lacks():
    """The pseudo-elasticity of Ogden and Roxburgh with the tanh of Dorfmann and Ogden."""
    z = 0.1 + Z - Z[0] + 0.002 * T
    q = values(
        "cyclic_softening", softening=1e-4, stroke_softening=0.4, stroke=0.3, unstretched=0.1
    )
    energy = 0.5 * (z - 0.1) ** 2
    lacking = np.maximum.accumulate(energy) - energy
    virgin = -(z - 0.1)
    kept = 1.0 - 0.4 * np.tanh(lacking / (0.5 * 0.3**2))
    found = virgin[:-1] + forces("cyclic_softening", q, z)
    assert np.allclose(found, (kept * virgin)[:-1], atol=1e-3)
    assert np.allclose(found[lacking[:-1] == 0.0], virgin[:-1][lacking[:-1] == 0.0], atol=1e-3)
    assert (lacking > 0.05).any()


def test_what_the_largest_stroke_takes_for_good_depends_on_nothing_else():
    """Damage that is not healed at the largest stroke either, at both signs of the stretch."""
    q = values("cyclic_softening", softening=1e-4, stroke_softening=0.4, stroke=0.3, regained=0.0)
    z = np.r_[0.0, 0.2, -0.1, 0.1, -0.5, 0.2, 0.5]
    largest = np.r_[0.0, 0.2, 0.2, 0.2, 0.5, 0.5]
    expected = 0.4 * np.tanh((largest / 0.3) ** 2) * z[:-1]
    assert np.allclose(forces("cyclic_softening", q, z), expected, atol=1e-3)


def test_stress_relaxes_with_time_and_not_with_the_way():
    q = values("stress_relaxation", relaxation=0.3, time=5.0, exponent=0.7, prestress=0.1)
    since = DT * np.arange(Z.size - 1)
    expected = (0.3 * Z[:-1] + 0.1) * (1 - np.exp(-((since / 5.0) ** 0.7)))
    assert np.allclose(forces("stress_relaxation", q), expected)


def test_second_mode_resonates_at_its_frequency():
    q = values("second_mode", coupling=1.0, frequency=1.5, damping_ratio=0.05, start_position=0.0)
    omega, h = 2 * np.pi * 1.5, 1e-3
    t = np.arange(40_000) * h
    amplitude = np.abs(forces("second_mode", q, 0.01 * np.sin(omega * t), h)[-1000:]).max()
    # The absorber's own motion exceeds the base by 1/(2 ζ) at resonance.
    assert amplitude == pytest.approx(0.01 * np.abs(1 - 1 / (2j * 0.05)), rel=0.02)


@pytest.mark.parametrize("grounded", [0.0, 0.6])
def test_second_mode_follows_the_equations_of_two_masses(grounded):
    own = {"coupling": 0.7, "frequency": 1.2, "damping_ratio": 0.1, "hardening": 2.0}
    q = values("second_mode", start_position=0.5, grounded_damping=grounded, asymmetry=0.5, **own)
    omega, loss = 2 * np.pi * 1.2, 2 * 0.1 / (2 * np.pi * 1.2)

    def place(t):
        return 0.5 + 0.3 * np.sin(2.2 * t) + 0.2 * (1 - np.cos(5.1 * t))

    def speed(t):
        return 0.66 * np.cos(2.2 * t) + 1.02 * np.sin(5.1 * t)

    def pull(t, state):
        stretch = place(t) - state[0]
        slide = (1 - grounded) * loss * (speed(t) - state[1])
        side = np.exp(np.where(stretch > 0.0, 0.5, -0.5))
        return side * stretch * (1 + 2.0 * stretch**2) + slide

    h = 2e-3
    t = np.arange(5000) * h
    solved = solve_ivp(
        lambda t, x: [x[1], omega**2 * (pull(t, x) - grounded * loss * x[1])],
        (0, t[-1]), [0.5, 0.0], t_eval=t, rtol=1e-9,
    )  # fmt: skip
    found = forces("second_mode", q, place(t), h)
    expected = -0.7 * pull(t, solved.y)[:-1]
    assert np.abs(found - expected).max() < 0.02 * np.abs(expected).max()


def test_end_stop_pushes_back_only_beyond_its_stops():
    q = values(
        "end_stop", upper_stop=0.9, lower_stop=0.5, stiffness=10.0, corner_width=1e-9, exponent=1.0
    )
    law = catalogue()["end_stop"].force
    for z, expected in ((0.7, 0.0), (0.95, -0.5), (0.4, 1.0)):
        assert law(z, 0.0, np.zeros(MEMORY), q) == pytest.approx(expected)


def test_a_stop_resists_by_a_power_of_the_depth_with_a_rounded_corner():
    own = {"upper_stop": 0.9, "lower_stop": 0.5, "stiffness": 10.0, "exponent": 2.0}
    law = catalogue()["end_stop"].force
    q = values("end_stop", corner_width=1e-9, **own)
    # The reference depth, at which the exponent has no influence, is a tenth of the range.
    depth = 0.1 * 0.6
    for z, force in ((0.9 + depth, -0.6), (0.5 - depth, 0.6), (0.9 + 2 * depth, -2.4)):
        assert law(z, 0.0, np.zeros(MEMORY), q) == pytest.approx(force)
    # A parabola that meets zero and the line at a corner's width from the stop.
    q = values("end_stop", corner_width=0.02, **own | {"exponent": 1.0})
    beyond = (-0.02, -0.01, 0.0, 0.01, 0.02)
    felt = (0.0, 0.00125, 0.005, 0.01125, 0.02)
    for depth, size in zip(beyond, felt, strict=True):
        assert law(0.9 + depth, 0.0, np.zeros(MEMORY), q) == pytest.approx(-10.0 * size)
        assert law(0.5 - depth, 0.0, np.zeros(MEMORY), q) == pytest.approx(10.0 * size)


def test_a_ball_leaves_a_stop_as_hunt_and_crossley_say():
    """Their coefficient of restitution is 1 - alpha v; the force is k x^n (1 + 1.5 alpha v)."""
    alpha, speed = 0.05, 1.0
    own = {"upper_stop": 0.9, "lower_stop": 0.0, "corner_width": 1e-9, "stiffness": 300.0}
    q = values("end_stop", exponent=1.5, damping=1.5 * alpha, onset=0.0, **own)
    assert bounce(q, 0.9, speed) == pytest.approx(1 - alpha * speed, abs=0.003)
    assert bounce(q, 0.0, -speed) == pytest.approx(1 - alpha * speed, abs=0.003)


def test_a_ball_leaves_a_spring_with_a_dashpot_as_schwager_and_poeschel_say():
    """Granular Matter 9 (2007) 465: the contact ends where it would pull."""
    own = {"upper_stop": 0.9, "lower_stop": 0.0, "corner_width": 1e-9, "stiffness": 100.0}
    q = values("end_stop", exponent=1.0, damping=0.03, onset=1.0, **own)
    # A dashpot c = stiffness * reference * damping, of a unit mass.
    beta = 0.5 * 100.0 * 0.06 * 0.03
    omega = np.sqrt(100.0 - beta**2)
    expected = np.exp(-beta / omega * (np.pi - np.arctan(2 * beta * omega / (omega**2 - beta**2))))
    assert bounce(q, 0.9, 1.0) == pytest.approx(expected, abs=0.003)


def bounce(q, stop, speed):
    """The part of its speed with which a unit mass comes back from a stop."""
    law, empty = catalogue()["end_stop"].force, np.zeros(MEMORY)

    def away(t, x):
        return np.sign(speed) * (stop - x[0]) + (1e-9 if t < 1e-6 else 0.0)

    away.terminal, away.direction = True, 1
    solved = solve_ivp(
        lambda t, x: [x[1], law(x[0], x[1], empty, q)],
        (0, 10), [stop, speed], events=away, rtol=1e-9, atol=1e-12, max_step=1e-3,
    )  # fmt: skip
    return -solved.y[1, -1] / speed


def test_what_an_output_limit_takes_is_kept_in_part_at_either_end():
    own = {"upper_end": 1.0, "lower_end": 0.5, "middle": 0.8, "sharpness": 200.0}
    law = catalogue()["output_saturation"].shape_output
    y = np.array([0.1, 0.7, 0.9, 1.4])
    found = law(y, y, values("output_saturation", remaining_slope=0.25, **own), DT)
    assert np.allclose(found, [0.4, 0.7, 0.9, 1.1], atol=2e-3)
    soft = law(y, y, values("output_saturation", **own | {"sharpness": 1.0}), DT)
    # At sharpness 1 a distance d from the middle becomes d / (1 + d / limit).
    expected = [0.8 - 0.7 * 0.3 / 1.0, 0.8 - 0.1 * 0.3 / 0.4, 0.8 + 0.1 * 0.2 / 0.3, 0.8 + 0.15]
    assert np.allclose(soft, expected)


def test_a_gain_never_changes_its_sign():
    falling = values("gain_drift", mode_1=-2.0)
    found = catalogue()["gain_drift"].scale_drive(T, falling)
    assert found.min() == pytest.approx(1e-3)
    assert found.max() > 2.0
    fault = values("step_fault", instant=11.0, gain_step=-3.0, rise_time=1.0)
    assert catalogue()["step_fault"].scale_drive(T, fault).min() == pytest.approx(1e-3)


def test_drifts_are_splines_of_time():
    own = {"mode_1": 0.1, "mode_2": 0.02, "mode_5": -0.03}
    gain = catalogue()["gain_drift"].scale_drive(T, values("gain_drift", **own))
    base = catalogue()["baseline_drift"].shape_output(Y, T, values("baseline_drift", **own), DT)
    weights = drift_modes()[0] @ [0.1, 0.02, 0.0, 0.0, -0.03, *[0.0] * (DRIFT_MODES - 5)]
    knots = np.arange(-3.0, 14.0)
    expected = BSpline(knots, weights, 3)(10.0 * T / 40.0)
    assert np.allclose(gain, 1 + expected)
    assert np.allclose(base, Y + expected)


def test_the_smoothest_mode_of_a_drift_is_straight_and_none_is_constant():
    for number in range(1, DRIFT_MODES + 1):
        q = values("baseline_drift", **{f"mode_{number}": 1.0})
        course = catalogue()["baseline_drift"].shape_output(np.zeros(T.size), T, q, DT)
        assert course.std() > abs(course.mean())
        if number == 1:
            assert np.corrcoef(course, T)[0, 1] > 0.9999


def test_a_drift_goes_on_straight_where_no_sample_tells_it():
    effect = catalogue()["baseline_drift"]
    prior = [p for p in effect.parameters(SCALES) if p.spread > 0]
    basis = [np.ones(T.size)]
    for p in prior:
        one = values("baseline_drift", **{p.name: p.spread})
        basis.append(effect.shape_output(np.zeros(T.size), T, one, DT))
    X = np.column_stack(basis)
    course = 0.04 * np.sqrt(T / 40.0) + 0.02 * np.sin(0.25 * T)
    known = T < 38.0
    A = X[known] / 1e-3
    weights = np.linalg.solve(A.T @ A + np.eye(A.shape[1]), A.T @ (course[known] / 1e-3))
    assert np.abs(X @ weights - course)[~known].max() < 0.003


def test_an_actuator_may_jam_within_a_part_of_its_range():
    event = {"instant": 11.01, "rise_time": 1e-6, "range_low": U.min(), "range_high": U.max()}
    q = values("step_fault", **event, highest_input=2.0, lowest_input=0.5)
    command = catalogue()["step_fault"].shape_input
    found = command(U, q, DT)
    late = T > 11.01
    np.testing.assert_array_equal(found[~late], U[~late])
    np.testing.assert_allclose(found[late], np.clip(U[late], 0.5, 2.0), atol=1e-12)
    stuck = values("step_fault", **event, highest_input=1.0, lowest_input=1.0)
    np.testing.assert_allclose(command(U, stuck, DT)[late], 1.0, atol=1e-12)
    assert np.array_equal(command(U, values("step_fault"), DT), U)
    # A constant that is added before moves the range with it.
    np.testing.assert_allclose(command(U + 0.1, values("step_fault"), DT), U + 0.1, atol=1e-12)
    np.testing.assert_allclose(command(U + 0.1, q, DT), found + 0.1, atol=1e-12)


def test_a_reading_may_be_late_from_one_instant_on():
    """The lag begins at the value that the output then has: dr/dt = (y - r) / time."""
    instant, tau = 11.0, 0.7
    q = values("step_fault", instant=instant, rise_time=1e-6, lag=tau)
    found = catalogue()["step_fault"].shape_output(Y, T, q, DT)
    late = instant <= T
    exact = solve_ivp(
        lambda t, r: (np.interp(t, T, Y) - r) / tau, (instant, T[-1]),
        [np.interp(instant, T, Y)], t_eval=T[late], rtol=1e-9, atol=1e-12, max_step=DT,
    ).y[0]  # fmt: skip
    np.testing.assert_array_equal(found[instant > T], Y[instant > T])
    np.testing.assert_allclose(found[late], exact, atol=1e-6)
    plain = catalogue()["step_fault"].shape_output(Y, T, values("step_fault"), DT)
    np.testing.assert_array_equal(plain, Y)


def test_step_fault_changes_gain_offset_and_scale_at_one_instant():
    q = values("step_fault", instant=11.01, gain_step=-0.2, offset_step=0.05, rise_time=1e-6)
    effect = catalogue()["step_fault"]
    after = T > 11.01
    assert np.allclose(effect.scale_drive(T, q), np.where(after, 0.8, 1.0))
    assert np.allclose(effect.shape_output(Y, T, q, DT), Y + 0.05 * after)
    slow = values("step_fault", instant=11.0, gain_step=0.4, offset_step=0.05, rise_time=2.0)
    t = np.array([9.9, 10.0, 10.5, 11.0, 11.5, 12.0, 12.1])
    share = np.array([0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0])
    assert np.allclose(effect.scale_drive(t, slow), 1.0 + 0.4 * share)
    assert np.allclose(effect.shape_output(np.zeros(7), t, slow, DT), 0.05 * share)
    scaled = values("step_fault", instant=11.01, offset_step=0.05, rise_time=1e-6, scale_step=-0.1)
    assert np.allclose(effect.scale_drive(T, scaled), 1.0)
    assert np.allclose(effect.shape_output(Y, T, scaled, DT), np.where(after, 0.9 * Y + 0.05, Y))


def test_a_part_of_a_step_may_be_taken_back_at_once_or_slowly():
    effect = catalogue()["step_fault"]
    step = {"instant": 11.0, "gain_step": -0.2, "offset_step": 0.05, "rise_time": 1e-6}
    t = np.array([10.9, 11.1, 13.9, 14.0, 14.5, 16.0, 30.0])
    sudden = values("step_fault", **step, held_for=3.0, return_time=1e-9, returned_part=0.75)
    assert np.allclose(effect.scale_drive(t, sudden), [1.0, *2 * [0.8], 0.8, *3 * [0.95]])
    slow = values("step_fault", **step, held_for=3.0, return_time=2.0, returned_part=1.0)
    left = np.array([0.0, 1.0, 1.0, 1.0, np.exp(-0.25), np.exp(-1.0), np.exp(-8.0)])
    assert np.allclose(effect.scale_drive(t, slow), 1.0 - 0.2 * left)
    assert np.allclose(effect.shape_output(np.zeros(7), t, slow, DT), 0.05 * left)


@pytest.mark.parametrize("seed", range(20))
def test_a_bent_reading_never_falls_while_the_output_rises(seed):
    """Whatever its modes; a curve that nowhere falls as fast as the output rises is as they say."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-2.0, 0.5)
    modes = {f"mode_{n}": size * m for n, m in enumerate(rng.standard_normal(11), 1)}
    q = values("sensor_nonlinearity", **modes, fold=SCALES.y_low - 10.0)
    y = np.linspace(SCALES.y_low, SCALES.y_high, 2001)
    read = catalogue()["sensor_nonlinearity"].shape_output(y, y, q, DT)
    assert np.diff(read).min() > 0.0
    # Uniform cubic B-splines over the range of the output.
    half, weights = 0.5 * (SCALES.y_high - SCALES.y_low), curve_modes()[0] @ q[:11]
    knots = SCALES.y_low + half * 2.0 / 9.0 * np.arange(-3, 13)
    bent = y + half * BSpline(knots, weights, 3)(np.minimum(y, y[-1] - 1e-12))
    steepest = np.diff(weights).min() * 9.0 / 2.0
    if steepest > -0.98:
        np.testing.assert_allclose(read, bent, atol=1e-9)
    else:
        assert np.abs(read - bent).max() > 1e-6


def test_sensor_nonlinearity_bends_and_folds():
    law = catalogue()["sensor_nonlinearity"].shape_output
    for place in (0.0, 0.7):
        q = values("sensor_nonlinearity", fold=place, corner_width=1e-9)
        signed = Y - 0.8 + place
        assert np.allclose(law(signed, T, q, DT), place + np.abs(signed - place))
    modes = np.random.default_rng(3).uniform(-0.05, 0.05, MODES)
    weights = curve_modes()[0] @ modes
    q = values("sensor_nonlinearity", **{f"mode_{n + 1}": m for n, m in enumerate(modes)})
    knots = np.linspace(-1 - 6 / 9, 1 + 6 / 9, 16)
    bend = BSpline(knots, weights, 3)((Y - 0.8) / 0.4)
    assert np.allclose(law(Y, T, q, DT), Y + 0.4 * bend)
    # Beyond its range the curve is as it was at the end.
    assert law(np.array([1.2, 1.5]), T[:2], q, DT) @ [-1, 1] == pytest.approx(0.3)


def test_periodic_disturbance_adds_its_lines():
    own = {"frequency": 2.0, "cosine_1": 0.01, "sine_2": 0.004}
    q = values("periodic_disturbance", **own, line_beside=0.9, sine_beside=0.003)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    phase = 2 * np.pi * 2.0 * T
    lines = 0.01 * np.cos(phase) + 0.004 * np.sin(2 * phase) + 0.003 * np.sin(0.45 * phase)
    assert np.allclose(found, lines)

    q = values("periodic_disturbance", frequency=2.0, cosine_1=0.01, phase_2=0.5)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    x = 2 * T / 40.0 - 1
    assert np.allclose(found, 0.01 * np.cos(phase + 0.5 * (1.5 * x**2 - 0.5)))
    grown = {"cosine_1": 0.01, "growth": 0.7, "middle": Y[5], "half_range": 10.0 * np.ptp(Y)}
    q = values("periodic_disturbance", frequency=2.0, **grown)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    assert np.allclose(found, 0.01 * np.cos(phase) * np.exp(0.07 * (Y - Y[5]) / np.ptp(Y)))


@pytest.mark.parametrize(
    ("lines", "beside"),
    [((1.3,), None), ((1.3, 2.6, 0.55), 0.55), ((1.3, 1.32), None), ((1.3, 3.2, 0.5), 3.2)],
)
def test_a_line_beside_a_periodic_disturbance_is_no_harmonic(lines, beside):
    effect = catalogue()["periodic_disturbance"]
    told = replace(SCALES, foreign_frequencies=lines)
    parameters = effect.parameters(told)
    at = [p.name for p in parameters].index("line_beside")
    free = [p.spread > 0 for p in parameters[at : at + 3]]
    assert free == [beside is not None] * 3
    for start in effect.starts(told):
        assert len(start) == len(parameters)
        assert start[at] == (beside or 0.0)


def test_sidebands_stand_on_either_side_of_the_wave_that_is_modulated():
    effect = catalogue()["periodic_disturbance"]
    told = replace(SCALES, foreign_frequencies=(1.3, 1.1))
    prior = {each.name: each.nominal for each in effect.parameters(told)}
    assert (prior["line_beside"], prior["line_opposite"]) == pytest.approx((1.1, 1.5))
    size, swing, slow = 0.01, 0.2, 2 * np.pi * 0.2
    q = values("periodic_disturbance", frequency=1.3, cosine_1=size,
               line_beside=1.1, cosine_beside=0.5 * swing * size,
               line_opposite=1.5, cosine_opposite=0.5 * swing * size)  # fmt: skip
    modulated = size * (1.0 + swing * np.cos(slow * T)) * np.cos(2 * np.pi * 1.3 * T)
    found = effect.shape_output(Y, T, q, DT) - Y
    np.testing.assert_allclose(found, modulated, atol=1e-9)


@pytest.mark.parametrize(("periods", "changes"), [(19, False), (21, True)])
def test_the_phase_of_a_disturbance_changes_slowly_over_many_periods_alone(periods, changes):
    """Whichever of several lines it is at."""
    own = {"frequency": periods / SCALES.duration, "cosine_1": 0.01}
    law = catalogue()["periodic_disturbance"].shape_output
    steady = law(Y, T, values("periodic_disturbance", **own), DT)
    for n in range(2, 7):
        wandering = law(Y, T, values("periodic_disturbance", **own, **{f"phase_{n}": 0.5}), DT)
        assert bool(np.abs(wandering - steady).max() > 1e-3) is changes


@given(st.sampled_from(sorted(catalogue())), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_no_law_leaves_the_numbers_within_its_bounds(name, seed):
    rng = np.random.default_rng(seed)
    effect = catalogue()[name]
    q = np.array([p.value(rng.normal()) for p in effect.parameters(SCALES)])
    if effect.shape_input:
        assert np.isfinite(effect.shape_input(U, q, DT)).all()
    if effect.shape_output:
        assert np.isfinite(effect.shape_output(Y, T, q, DT)).all()
    if effect.scale_drive:
        assert np.isfinite(effect.scale_drive(T, q)).all()
    if effect.force:
        assert np.isfinite(forces(name, q, Z[:200])).all()


def test_an_empty_slot_does_nothing():
    memory = np.arange(MEMORY, dtype=float)
    no_update(0.0, 1.0, 0.1, memory, np.zeros(3))
    assert no_force(1.0, 1.0, memory, np.zeros(3)) == 0.0
    assert (memory == np.arange(MEMORY)).all()
    assert SLOTS >= 2


@pytest.mark.parametrize("effect", ["dead_zone", "input_saturation"])
def test_a_negative_input_has_the_starts_of_its_mirror_image(effect):
    positive = replace(SCALES, u_low=1.0, u_high=5.0)
    mirrored = replace(SCALES, u_low=-5.0, u_high=-1.0)
    resting = replace(SCALES, u_low=-0.9, u_high=0.0)
    starts = catalogue()[effect].starts
    assert starts(mirrored) == starts(positive)
    assert all(0.0 < start[0] < 0.9 for start in starts(resting))


@pytest.mark.parametrize("unit", [1e-11, 1e13])
def test_a_limit_of_the_sensor_is_the_same_in_every_unit(unit):
    law = catalogue()["output_saturation"].shape_output
    y, t = np.linspace(0.0, 3.0, 50), np.arange(50.0)
    q = np.array([2.0, 0.5, 20.0, 0.1, 1.0])
    scaled = q * np.array([unit, unit, 1.0, 1.0, unit])
    np.testing.assert_allclose(law(unit * y, t, scaled, 1.0), unit * law(y, t, q, 1.0), rtol=1e-9)


@pytest.mark.parametrize("at_input", [False, True])
@pytest.mark.parametrize("swing", [0.5, 0.75])
def test_the_loop_of_backlash_has_the_area_of_its_parallelogram_at_any_rate(swing, at_input):
    """A play of gap g under a swing s holds the area g (s - g)."""
    effect, gap = catalogue()["backlash"], 0.3
    for samples in (500, 4000):
        y = 0.8 + 0.5 * swing * np.sin(2 * np.pi * np.arange(2 * samples) / samples)
        if at_input:
            read = effect.shape_input(y, values("backlash", command_gap=gap), DT)
        else:
            read = effect.shape_output(y, np.zeros(y.size), values("backlash", gap=gap), DT)
        y, read = y[samples:], read[samples:]
        area = abs(np.sum(0.5 * (read + np.roll(read, 1)) * (y - np.roll(y, 1))))
        np.testing.assert_allclose(area, gap * (swing - gap), rtol=2e-3)


def test_the_gap_of_backlash_may_change_along_the_range():
    """Half of it lies between output and reading while the output rises, or falls."""
    y = np.concatenate([np.linspace(0.8, 1.2, 400), np.linspace(1.2, 0.4, 800)])
    q = values("backlash", gap=0.1, tilt=0.4, growth_at_ends=-0.3)
    read = catalogue()["backlash"].shape_output(y, np.zeros(y.size), q, DT)
    half = 0.05 * (1.0 + 0.4 * (y - 0.8) / 0.4 - 0.3 * ((y - 0.8) / 0.4) ** 2)
    np.testing.assert_allclose(read[200:400], (y - half)[200:400], atol=1e-12)
    np.testing.assert_allclose(read[700:], (y + half)[700:], atol=1e-12)


def test_a_contact_of_backlash_that_gives_lags_behind_a_ramp_by_its_speed():
    """In its steady state the reading follows by half the gap and the time constant at speed."""
    y, drag, fine = 0.4 + 0.05 * np.arange(0.0, 15.0, 0.002), 0.3, 0.002
    q = values("backlash", gap=0.1, drag=drag)
    read = catalogue()["backlash"].shape_output(y, np.zeros(y.size), q, fine)
    np.testing.assert_allclose(y[-1] - read[-1], 0.05 + 0.05 * drag, rtol=1e-3)


def test_within_its_gap_backlash_shows_no_motion_and_beyond_it_all():
    effect = catalogue()["backlash"]
    y = np.array([1.0, 1.1, 1.25, 1.6, 1.5, 1.35, 1.2, 0.9, 1.0, 1.3])
    for place, begun in ((1.0, 0.85), (0.0, 1.0), (-1.0, 1.15)):
        at_reading = values("backlash", gap=0.3, place=place)
        read = effect.shape_output(y, np.zeros(y.size), at_reading, DT)
        at_input = values("backlash", command_gap=0.3, command_place=place)
        up = [max(begun, each) for each in (0.85, 0.95, 1.1)]
        expected = [*up, 1.45, 1.45, 1.45, 1.35, 1.05, 1.05, 1.15]
        np.testing.assert_allclose(read, expected)
        np.testing.assert_allclose(effect.shape_input(y, at_input, DT), expected)
        np.testing.assert_array_equal(effect.shape_input(y, at_reading, DT), y)
        np.testing.assert_array_equal(effect.shape_output(y, np.zeros(y.size), at_input, DT), y)


@pytest.mark.parametrize("samples", [100, 160, 600, 5000])
@pytest.mark.parametrize("name", ["electrode_lag", "sensor_lag"])
def test_lags_start_apart_and_the_longest_where_a_record_holds_many_of_it(name, samples):
    scales = replace(SCALES, duration=samples * SCALES.interval)
    starts = catalogue()[name].starts(scales)
    assert len(set(starts)) == len(starts)
    longest = max(law[0] for law in starts)
    assert longest == pytest.approx((100.0 if samples > 600 else 30.0) * SCALES.interval)
