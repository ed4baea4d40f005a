"""Limited rates and transport delays of an input, against what shares nothing with them."""

import numpy as np
import pytest
from law_values import DT, values
from made_signals import T, U
from scipy.integrate import solve_ivp

from dea.simulation import catalogue


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
