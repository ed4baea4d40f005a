import numpy as np
import pytest
from law_values import DT, values
from scipy.integrate import solve_ivp

from dea.simulation import catalogue
from dea.simulation.effects._laws import held_charge, limited
from dea.simulation.effects.input_saturation import law


@pytest.mark.parametrize("sharpness", [1.0, 8.0, 200.0])
def test_a_limit_of_zero_is_where_smaller_and_smaller_limits_lead(sharpness):
    assert limited(1.0, 0.0, sharpness) == 0.0
    assert limited(1.0, 1e-9, sharpness) == pytest.approx(0.0, abs=1e-8)


def test_an_input_may_be_cut_off_on_its_negative_side():
    shaped = law(np.array([-2.0, -0.5, 0.0, 0.5]), np.array([1.0, 200.0, 0.0, 0.0, 0.0]), 0.02)
    np.testing.assert_allclose(shaped, [0.0, 0.0, 0.0, 0.5], atol=1e-9)


@pytest.mark.parametrize(("falling", "growth"), [(1.0, 0.0), (2.0, 0.0), (1.0, 1.5), (3.0, 1.0)])
def test_a_lag_grows_with_what_it_holds(falling, growth):
    interval, tau = 1e-3, 0.05
    u = np.repeat([0.0, 1.0, 0.3, 0.8], 200)

    def slope(t, v, target):
        factor = falling if target < v[0] else 1.0
        return [(target - v[0]) / (tau * factor * np.exp(growth * v[0] ** 2))]

    held, found, expected = 0.0, [], [0.0]
    for target in u:
        mean, held = held_charge(held, target, tau, falling, growth, interval)
        found.append(mean)
        path = solve_ivp(slope, (0.0, interval), expected[-1:], args=(target,), rtol=1e-8)
        expected.append(path.y[0, -1])
    middle = 0.5 * (np.array(expected[1:]) + np.array(expected[:-1]))
    assert np.abs(np.array(found) - middle).max() < 3e-3


def test_a_threshold_may_fall_once_it_is_overcome():
    """What is told sample by sample: 2 V are needed, and 1.2 V kept; either sign by itself."""
    u = np.array([0.0, 1.5, 1.9, 2.1, 1.9, 1.3, 1.1, 1.5, 2.5, -1.5, -2.5, -1.3, 0.0, -1.9])
    q = values(
        "dead_zone", threshold=2.0, corner_width=1e-9, slope=1.0, negative_ratio=1.0, drop=0.4
    )
    found = catalogue()["dead_zone"].shape_input(u, q, DT)
    expected = [0.0, 0.0, 0.0, 0.9, 0.7, 0.1, 0.0, 0.0, 1.3, 0.0, -1.3, -0.1, 0.0, 0.0]
    np.testing.assert_allclose(found, expected, atol=1e-7)


def test_a_held_threshold_with_a_soft_corner_is_left_without_a_jump():
    q = values("dead_zone", threshold=2.0, corner_width=0.8, slope=1.0, drop=0.4)
    falling = np.linspace(3.0, 0.0, 3001)
    found = catalogue()["dead_zone"].shape_input(falling, q, DT)
    assert np.abs(np.diff(found)).max() < 2e-3


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_limit_may_be_left_late(sign):
    """Against small steps of the charge, over intervals of a held input."""
    limit, time, fine = 3.0, 0.4, 400
    u = np.repeat(np.random.default_rng(3).uniform(1.0, 4.5, 40), 10)
    q = values("input_saturation", limit=limit, sharpness=200.0, recovery=time, negative_ratio=1.0)
    found = catalogue()["input_saturation"].shape_input(sign * u, q, DT)
    charge, expected = 0.0, []
    for v in u:
        total = 0.0
        for _ in range(fine):
            charge = max(charge + DT / fine * (v - limit - charge / time), 0.0)
            total += limit if charge > 0.0 else v
        expected.append(sign * total / fine)
    assert np.abs(found - expected).max() < 0.06
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.01
    soon = catalogue()["input_saturation"].shape_input(
        u, values("input_saturation", limit=limit, sharpness=200.0, recovery=1e-6), DT
    )
    plain = catalogue()["input_saturation"].shape_input(
        u, values("input_saturation", limit=limit, sharpness=200.0), DT
    )
    assert np.abs(np.abs(found) - plain).max() > 1.0
    np.testing.assert_allclose(soon, plain, atol=1e-3)


@pytest.mark.parametrize("ratio", [1.0, 0.5, 0.0])
def test_a_limit_that_is_left_late_limits_either_sign(ratio):
    """Against small steps, each of which is limited on the side of its charge or of its input."""
    limit, time, fine = 3.0, 0.1, 400
    u = np.repeat(np.random.default_rng(5).uniform(-4.5, 4.5, 60), 8)
    q = values(
        "input_saturation", limit=limit, sharpness=200.0, recovery=time, negative_ratio=ratio
    )
    found = catalogue()["input_saturation"].shape_input(u, q, DT)
    charge, side, expected = 0.0, 1.0, []
    for v in u:
        total = 0.0
        for _ in range(fine):
            side = side if charge > 0.0 else 1.0 if v >= 0.0 else -1.0
            own = limit if side > 0.0 else limit * ratio
            charge = max(charge + DT / fine * (side * v - own - charge / time), 0.0)
            side = side if charge > 0.0 else 1.0 if v >= 0.0 else -1.0
            own = limit if side > 0.0 else limit * ratio
            total += side * (own if charge > 0.0 else min(side * v, own))
        expected.append(total / fine)
    assert np.abs(found - expected).max() < 0.08
    soon, plain = (
        catalogue()["input_saturation"].shape_input(
            u, values("input_saturation", limit=limit, negative_ratio=ratio, recovery=each), DT
        )
        for each in (1e-9, 0.0)
    )
    np.testing.assert_allclose(soon, plain, atol=1e-5)


@pytest.mark.parametrize("own_share", [0.0, 1.0])
@pytest.mark.parametrize("damping", [1.0, 0.4])
def test_a_sensor_may_be_quicker_where_its_level_or_its_reading_is_high(damping, own_share):
    """Against the equation with both times divided by a rate that follows the one or the other."""
    tau, quickening = 0.3, 0.8
    own = {"damping": damping, "quickening": quickening, "own_share": own_share}
    q = values("sensor_lag", time_constant=tau, **own)

    def level(t):
        return 0.8 + 0.3 * np.sin(2.0 * t) + 0.1 * np.sin(5.3 * t + 1.0)

    def slope(t, x):
        high = own_share * x[0] + (1.0 - own_share) * level(t)
        rate = np.exp(quickening * (high - 0.8) / 0.4)
        natural = 2.0 * damping / tau
        pull = natural**2 * (level(t) - x[0]) - 2.0 * damping * natural * x[1]
        return [rate * x[1], rate * pull]

    t = np.arange(1000) * DT
    found = catalogue()["sensor_lag"].shape_output(level(t), t, q, DT)
    expected = solve_ivp(slope, (0.0, t[-1]), [level(0.0), 0.0], t_eval=t, rtol=1e-9, atol=1e-12).y[
        0
    ]
    assert np.abs(found - expected).max() < (1e-3 if own_share else 5e-4)
    slightly = values(
        "sensor_lag", time_constant=tau, damping=damping, quickening=1e-9, fast_part=0.3
    )
    plain = values("sensor_lag", time_constant=tau, damping=damping, fast_part=0.3)
    law = catalogue()["sensor_lag"].shape_output
    np.testing.assert_allclose(
        law(level(t), t, slightly, DT), law(level(t), t, plain, DT), atol=3e-5
    )
