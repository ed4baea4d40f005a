"""Hidden forces against another statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import at, held, resist, steady, sweep
from made_draws import SHARES, UNEVEN, drawn
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from dea.plant.film import SUBSTEP

K, TRAVEL, TIME = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.time
BOTTOM, TOP, REST, LAST = UNEVEN.bottom, UNEVEN.top, UNEVEN.rest, UNEVEN.duration
FORCE = K * TRAVEL


def mittag_leffler(order, x):
    """Return E(-x^order), by the integral of Gorenflo and Mainardi (1997) over rates."""

    def density(logarithm):
        r = np.exp(logarithm)
        power = r**order
        weight = power * np.sin(np.pi * order)
        return (
            np.exp(-r * x) * weight / (power**2 + 2 * power * np.cos(np.pi * order) + 1.0) / np.pi
        )

    return quad(density, -40.0, 40.0, limit=400)[0]


@pytest.mark.parametrize("share", SHARES)
def test_the_fractional_solid_relaxes_as_mittag_leffler_s_function(share):
    made, _, draws = drawn("fractional_zener", 0.3, share)
    order, middle = draws.at(0.5, 0.75), draws.log(0.5, 5.0)
    periods = np.array([0.3, 1.0, 3.0, 10.0])
    felt = at(held(made, REST + 1.0, 10.0 * TIME), *(periods * TIME))
    expected = np.array([mittag_leffler(order, x / middle) for x in periods])
    assert felt[1] == pytest.approx(0.3 * K, rel=1e-2)
    np.testing.assert_allclose(felt / felt[1], expected / expected[1], rtol=0.05)


@pytest.mark.parametrize("share", SHARES)
def test_the_prestress_relaxes_as_a_stretched_exponential(share):
    made, _, draws = drawn("stretched_relaxation", 0.2, share)
    time, order = draws.at(0.1, 0.6) * LAST, draws.at(0.5, 0.8)
    seconds = np.array([0.2, 1.0, 2.0, 4.0])
    lost = 1.0 - np.exp(-((seconds / time) ** order))
    felt = at(held(made, 3.0, LAST), *seconds)
    np.testing.assert_allclose(felt, -0.2 * K * 3.0 * lost / lost[-1], rtol=1e-3)


@pytest.mark.parametrize("share", SHARES)
def test_ramberg_and_osgood_s_branches_are_a_line_and_a_power(share):
    made, _, draws = drawn("ramberg_osgood", 0.5, share)
    length, order = draws.at(0.1, 0.4) * TRAVEL, draws.at(3.0, 7.0)
    scale = 0.5 * K * length

    def force(way):
        return scale * brentq(lambda f: f + f**order - way / length, 0.0, way / length + 1.0)

    path = sweep(9.0, 2.0, 6.0, start=REST)
    felt = resist(made, path)
    first, up, down = felt[200], felt[400] - felt[800], felt[1000] - felt[800]
    # The first curve is half as large as a branch of twice the length.
    assert first == pytest.approx(0.5 * force(2.0 * (path[200] - REST)), rel=1e-6)
    assert up == pytest.approx(force(7.0), rel=1e-6)
    assert down == pytest.approx(force(2.0), rel=1e-6)


@pytest.mark.parametrize("share", SHARES)
def test_friction_falls_with_the_square_of_the_speed(share):
    made, _, draws = drawn("hess_soom", 0.05, share)
    sliding, mean = 0.05 * FORCE, UNEVEN.speed
    excess, slow = draws.at(0.1, 0.6), draws.at(0.2, 0.8) * mean
    speeds = mean * np.array([0.01, 0.3, 1.0, 4.0, 40.0])
    near = np.sin(np.arctan(speeds / (0.03 * mean)))
    expected = sliding * (1.0 + excess * slow**2 / (slow**2 + speeds**2)) * near
    np.testing.assert_allclose(steady(made, speeds), expected, rtol=1e-9)
    np.testing.assert_allclose(steady(made, -speeds), -expected, rtol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_the_toe_is_an_exponential_that_ends_in_its_tangent(share):
    made, _, draws = drawn("tendon_toe", 0.4, share)
    toe, steep = draws.at(0.5, 0.8), draws.at(4.0, 7.0)
    path = np.linspace(BOTTOM, TOP + 0.2 * TRAVEL, 40_001)
    d = (path - BOTTOM) / TRAVEL
    slopes = np.exp(steep / toe * np.minimum(d, toe))
    grown = np.concatenate([[0.0], np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(d))])
    expected = 0.4 * FORCE * grown / np.interp(1.0, d, grown)
    np.testing.assert_allclose(resist(made, path), expected, atol=1e-5 * FORCE)


@pytest.mark.parametrize("share", SHARES)
def test_the_stages_are_two_powers_of_the_cycles(share):
    made, _, draws = drawn("three_stages", 0.2, share)
    first, part, last = draws.at(0.2, 0.4), draws.at(0.3, 0.7), draws.at(4.0, 8.0)
    path = sweep(*[TOP, BOTTOM] * 25, start=BOTTOM, points=100)
    felt = resist(made, path)
    # At the middle of each way down; the way up before it is noted, at its full swing.
    halves = np.arange(1, 50, 2)
    middle = halves * 100 + 50
    ratio = 0.5 * halves / UNEVEN.cycles
    expected = 0.2 * (part * ratio**first + (1.0 - part) * ratio**last)
    np.testing.assert_allclose(-felt[middle] / (K * path[middle]), expected, rtol=1e-6)


@pytest.mark.parametrize("share", SHARES)
def test_masses_in_series_move_as_another_integrator_says(share):
    made, defining, draws = drawn("masses_in_series", 0.3, share)
    mass, spring, dashpot, carried, second, between = made.constants
    assert spring == pytest.approx(0.3 * K)
    assert carried / mass == pytest.approx(draws.at(0.1, 0.5))
    assert second / carried / (spring / mass) == pytest.approx(draws.at(0.8, 1.6))
    stiff = np.array([[spring + second, -second], [-second, second]])
    lowest = np.sqrt(np.linalg.eigvals(np.diag([1.0 / mass, 1.0 / carried]) @ stiff).min().real)
    assert defining == {"frequency": pytest.approx(lowest / (2.0 * np.pi))}
    assert defining["frequency"] * TIME == pytest.approx(draws.at(0.6, 1.6))
    place = REST + 2.0

    def move(t, s):
        low, high = place - s[0], s[0] - s[2]
        pull = second * high + between * (s[1] - s[3])
        return [s[1], (spring * low - dashpot * s[1] - pull) / mass, s[3], pull / carried]

    solved = solve_ivp(move, (0.0, 3.0), [REST, 0, REST, 0], rtol=1e-9, dense_output=True)
    times = np.arange(1, 3000) * SUBSTEP
    s = solved.sol(times)
    expected = spring * (place - s[0]) - dashpot * s[1]
    felt = held(made, place, 3.0)[: times.size]
    np.testing.assert_allclose(felt, expected, atol=0.04 * spring * 2.0)


@pytest.mark.parametrize("share", SHARES)
def test_a_cone_s_force_is_the_square_of_its_depth(share):
    made, defining, draws = drawn("pressed_cone", 0.3, share)
    place = TOP - 0.3 * TRAVEL
    assert defining == {"limit": pytest.approx(place)}
    path = np.linspace(BOTTOM, TOP, 500)
    depth = np.maximum(path - place, 0.0) / (0.02 * TRAVEL)
    expected = draws.at(5.0, 20.0) * 0.02 * FORCE * depth**2
    np.testing.assert_allclose(resist(made, path), expected, atol=1e-9)
