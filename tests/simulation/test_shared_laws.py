"""What several laws share, against closed forms, integrals and SciPy."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import BSpline, lagrange
from scipy.signal import lsim

from dea.simulation.effects._laws import (
    DRIFT_MODES,
    delayed,
    delayed_smoothly,
    drift,
    drift_modes,
    drift_starts,
    held_charge,
    held_lag,
    knee,
    limited,
    low_pass,
    low_pass_step,
    powered,
    remaining,
    smooth_modes,
    spline,
)


@pytest.mark.parametrize("x", [-2.0, -0.5, -0.49, -0.1, 0.0, 0.3, 0.49, 0.5, 2.0])
def test_a_knee_is_the_mean_of_corners_within_its_width(x):
    mean = quad(lambda s: max(x + s, 0.0), -0.5, 0.5, points=[-x])[0]
    assert knee(x, 0.5) == pytest.approx(mean, abs=1e-12)


@pytest.mark.parametrize("x", [-1.0, 0.0, 1.0])
def test_a_knee_without_width_is_a_corner(x):
    assert knee(x, 0.0) == max(x, 0.0)


@pytest.mark.parametrize("sharpness", [1.0, 2.5, 8.0])
@pytest.mark.parametrize("x", [0.01, 1.9, 2.0, 2.1, 40.0])
def test_a_soft_limit_follows_its_formula(x, sharpness):
    expected = x / (1.0 + (x / 2.0) ** sharpness) ** (1.0 / sharpness)
    assert limited(x, 2.0, sharpness) == pytest.approx(expected, rel=1e-12)


def test_a_hard_limit_is_a_corner_however_far_beyond_it():
    for x in (1e-3, 1.0, 1e6):
        assert limited(x, 2.0, 1e3) == pytest.approx(min(x, 2.0), rel=1e-3)
    for x in (0.0, -3.0):
        assert limited(x, 2.0, 8.0) == limited(x, 0.0, 8.0) == x
    assert limited(3.0, -1.0, 8.0) == 0.0


@pytest.mark.parametrize(
    ("v", "target", "falling", "growth"),
    [(0.2, 1.0, 3.0, 0.0), (1.0, 0.2, 3.0, 0.0), (0.7, 1.0, 1.0, 0.8), (0.7, -0.4, 2.0, 0.8)],
)
def test_a_lag_leaves_over_what_its_equation_does(v, target, falling, growth):
    """The time constant grows with the value at the start of the interval."""
    tau, interval = 0.3, 0.2
    own = tau * (falling if target < v else 1.0) * np.exp(growth * v**2)
    path = solve_ivp(
        lambda t, x: [(target - x[0]) / own, x[0]], (0.0, interval), [v, 0.0],
        rtol=1e-10, atol=1e-12,
    ).y[:, -1]  # fmt: skip
    mean, end = held_charge(v, target, tau, falling, growth, interval)
    assert (mean, end) == pytest.approx((path[1] / interval, path[0]), rel=1e-8)
    part, left = remaining(v, target, tau, falling, growth, interval)
    assert target + (v - target) * part == pytest.approx(mean)
    assert target + (v - target) * left == pytest.approx(end)


@pytest.mark.parametrize("tau", [1e3, 1e6, 1e8, 1e11, 1e300, np.inf])
def test_over_an_interval_far_shorter_than_its_time_constant_a_lag_stays(tau):
    for each in remaining(2.0, 5.0, tau, 1.0, 0.0, 0.02):
        assert each == pytest.approx(1.0 - 0.02 / tau, abs=0.02 / tau + 1e-6)
    np.testing.assert_allclose(held_charge(2.0, 5.0, tau, 1.0, 0.0, 0.02), 2.0, atol=1e-4)


@pytest.mark.parametrize("order", [1.0, 1.01, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("tau", [0.03, 0.3, 30.0])
def test_a_charge_approaches_with_a_power_of_the_distance(order, tau):
    """From 2 up to 5, by an adaptive integration of the distance and of its mean."""
    interval, first = 0.2, 3.0

    def slope(t, x):
        return [-first / tau * max(x[0] / first, 0.0) ** order, x[0] / interval]

    x, mean = solve_ivp(slope, (0, interval), [first, 0.0], rtol=1e-9, atol=1e-11).y[:, -1]
    found = powered(2.0, 5.0, tau, 0.5, 0.0, interval, order)
    np.testing.assert_allclose(found, (5.0 - mean, 5.0 - x), atol=1e-5)
    falling = powered(5.0, 2.0, 2.0 * tau, 0.5, 0.0, interval, order)
    np.testing.assert_allclose(falling, (2.0 + mean, 2.0 + x), atol=1e-5)


def test_a_held_lag_has_settled_at_the_first_input_and_follows_steps():
    u = np.repeat([2.0, -1.0, 0.5], 40)
    tau, interval, fine = 0.13, 0.02, 400
    t = np.arange(u.size * fine + 1) * interval / fine
    steps = np.append(np.repeat(u, fine), u[-1])
    path = lsim(([1.0], [tau, 1.0]), steps, t, X0=[2.0 * tau])[1]
    means = path[:-1].reshape(-1, fine).mean(axis=1)
    np.testing.assert_allclose(held_lag(u, tau, interval), means, atol=5e-3)
    assert held_lag(u, tau, interval)[0] == 2.0


@pytest.mark.parametrize("delay", [0.0, 0.005, 0.02, 0.07, 0.1, 5.0])
def test_a_delay_goes_straight_between_samples_and_holds_the_first(delay):
    u = np.random.default_rng(1).standard_normal(50)
    t = 0.02 * np.arange(50)
    np.testing.assert_allclose(delayed(u, delay, 0.02), np.interp(t - delay, t, u), atol=1e-12)


@pytest.mark.parametrize("samples", [0.0, 0.25, 1.0, 2.7, 9.5, 70.0])
def test_a_smooth_delay_takes_the_cubic_through_the_four_samples_around(samples):
    """Before the first sample and after the last one these go on."""
    u = np.random.default_rng(2).standard_normal(40)
    found = delayed_smoothly(u, samples * 0.02, 0.02)
    for k in range(40):
        before = int(np.floor(k - samples))
        around = np.arange(before - 1, before + 3)
        if samples % 1.0 == 0.0:
            expected = u[max(before, 0)]
        else:
            cubic = lagrange(np.arange(4.0), u[np.clip(around, 0, 39)])
            expected = cubic(k - samples - around[0])
        assert found[k] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("polynomial", [(2.5, 1.0), (4.0, 1.2, 1.0), (2.0, 3.0, 1.5, 1.0)])
def test_a_low_pass_begins_at_rest_and_follows_straight_lines(polynomial):
    y = 3.0 + np.cumsum(np.random.default_rng(3).standard_normal(60))
    expected = y[0] + lsim(([1.0], polynomial), y - y[0], np.arange(60.0))[1]
    np.testing.assert_allclose(low_pass(y, polynomial), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("polynomial", [(2.5, 1.0), (4.0, 1.2, 1.0), (2.0, 3.0, 1.5, 1.0)])
def test_states_of_a_low_pass_step_as_its_equation_does(polynomial):
    """The signal is one, then t, then t squared over two."""
    order = len(polynomial) - 1
    states, gained = low_pass_step(polynomial, 2)
    assert states.shape == (order, order)
    assert gained.shape == (3, order)

    def after(start, signal):
        def slope(t, x):
            highest = (signal(t) - np.dot(polynomial[:0:-1], x)) / polynomial[0]
            return [*x[1:], highest]

        return solve_ivp(slope, (0.0, 1.0), start, rtol=1e-11, atol=1e-13).y[:, -1]

    for k in range(order):
        start = np.eye(order)[k]
        np.testing.assert_allclose(states[:, k], after(start, lambda t: 0.0), atol=1e-8)
    signals = (lambda t: 1.0, lambda t: t, lambda t: 0.5 * t**2)
    for row, signal in zip(gained, signals, strict=True):
        np.testing.assert_allclose(row, after(np.zeros(order), signal), atol=1e-8)


def test_a_spline_is_that_of_uniform_knots_up_to_both_ends():
    weights = np.random.default_rng(4).standard_normal(9)
    places = np.linspace(0.0, 6.0, 61)
    expected = BSpline(np.arange(-3.0, 10.0), weights, 3)(places)
    np.testing.assert_allclose([spline(p, weights) for p in places], expected, atol=1e-12)


@pytest.mark.parametrize(("pieces", "bend"), [(6, 0.3), (10, 0.06)])
def test_modes_have_the_prior_of_weights_that_bend_slightly(pieces, bend):
    """A draw is a constant and modes: its second differences deviate by ``bend`` if that is all."""
    modes, deviations = smooth_modes(pieces, bend)
    size = pieces + 3
    assert modes.shape == (size, size - 1)
    np.testing.assert_allclose(modes.T @ modes, size * np.eye(size - 1), atol=1e-9)
    np.testing.assert_allclose(modes.sum(axis=0), 0.0, atol=1e-6)
    assert (modes[-1] > 0.0).all()
    assert (np.diff(deviations) < 0.0).all()
    covariance = (modes * deviations**2) @ modes.T
    slopes, bends = (np.diff(np.eye(size), n, axis=0) for n in (1, 2))
    precision = np.eye(size) / size + 1e-3 * slopes.T @ slopes + bends.T @ bends / bend**2
    whole = covariance + 1.0  # a constant deviates by one
    np.testing.assert_allclose(whole @ precision, np.eye(size), atol=1e-8)
    spread = np.sqrt(np.diag(bends @ covariance @ bends.T))
    np.testing.assert_allclose(spread, bend, rtol=0.05)


def test_no_mode_deviates_by_more_than_the_most():
    free = smooth_modes(10, 0.06)[1]
    modes, limited_ones = smooth_modes(10, 0.06, 0.5)
    np.testing.assert_array_equal(limited_ones, np.minimum(free, 0.5))
    np.testing.assert_array_equal(modes, smooth_modes(10, 0.06)[0])
    straight = modes[:, 0]
    assert np.corrcoef(straight, np.arange(straight.size))[0, 1] > 0.999


def test_a_drift_has_ten_pieces_over_its_duration_and_stands_still_outside():
    own = np.random.default_rng(5).standard_normal(DRIFT_MODES)
    weights = drift_modes()[0] @ own
    assert weights.size == 13
    t = np.linspace(-5.0, 25.0, 121)
    course = BSpline(np.arange(-3.0, 14.0), weights, 3)
    expected = course(np.clip(t / 2.0, 0.0, 10.0))
    np.testing.assert_allclose(drift(t, 20.0, own), expected, atol=1e-9)


def test_drifts_start_as_rises_and_falls_of_the_two_smoothest_modes():
    starts = drift_starts(0.3, 40.0)
    modes = np.array([start[:-1] for start in starts])
    assert {start[-1] for start in starts} == {40.0}
    expected = np.zeros((4, DRIFT_MODES))
    expected[[0, 1], 0] = expected[[2, 3], 1] = 0.3, -0.3
    np.testing.assert_array_equal(modes, expected)
