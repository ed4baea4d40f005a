import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dea.simulation.effects._laws import held_charge, limited
from dea.simulation.effects.input_saturation import law


@pytest.mark.parametrize("sharpness", [1.0, 8.0, 200.0])
def test_a_limit_of_zero_is_where_smaller_and_smaller_limits_lead(sharpness):
    assert limited(1.0, 0.0, sharpness) == 0.0
    assert limited(1.0, 1e-9, sharpness) == pytest.approx(0.0, abs=1e-8)


def test_an_input_may_be_cut_off_on_its_negative_side():
    shaped = law(np.array([-2.0, -0.5, 0.0, 0.5]), np.array([1.0, 200.0, 0.0, 0.0]), 0.02)
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
