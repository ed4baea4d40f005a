"""Lags of electrodes and of sensors, against other integrators and frequency responses."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import T, U, Y
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import cont2discrete, lfilter, lfilter_zi, lti

from dea.simulation import catalogue
from dea.simulation.effects._laws import low_pass


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


def test_a_sensor_that_lags_is_at_rest_before_the_record():
    q = values("sensor_lag", time_constant=0.3, damping=0.3, delay_ratio=0.5)
    smooth = catalogue()["sensor_lag"].shape_output(np.full(T.size, 0.8), T, q, DT)
    assert np.allclose(smooth, 0.8, rtol=1e-9)


@pytest.mark.parametrize("samples", [100, 160, 600, 5000])
@pytest.mark.parametrize("name", ["electrode_lag", "sensor_lag"])
def test_lags_start_apart_and_the_longest_where_a_record_holds_many_of_it(name, samples):
    scales = replace(SCALES, duration=samples * SCALES.interval)
    starts = catalogue()[name].starts(scales)
    assert len(set(starts)) == len(starts)
    longest = max(law[0] for law in starts)
    assert longest == pytest.approx((100.0 if samples > 600 else 30.0) * SCALES.interval)
