"""Hidden forces against another statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import at, held, integrated, resist, steady, sweep
from made_draws import SHARES, UNEVEN, drawn
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from dea.plant import forces
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
    ratio = 0.5 * halves / UNEVEN.full_cycles
    expected = np.minimum(0.2 * (part * ratio**first + (1.0 - part) * ratio**last), 0.9)
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

    s = integrated(move, [REST, 0, REST, 0], 3.0)
    expected = spring * (place - s[0]) - dashpot * s[1]
    felt = held(made, place, 3.0)[:-1]
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


@pytest.mark.parametrize("share", SHARES)
def test_chains_creep_ever_less_as_another_integrator_says(share):
    made, defining, draws = drawn("bergstrom_boyce", 0.3, share)
    assert not defining
    length, time = draws.at(0.1, 0.4) * TRAVEL, TIME * draws.log(0.2, 2.0)
    order, own = draws.at(2.0, 5.0), draws.at(0.05, 0.3) * TRAVEL
    for stretch in (4.0, -4.0):

        def flow(t, x, stretch=stretch):
            rate = length / time * (np.abs(stretch - x) / length) ** order
            return np.sign(stretch) * rate * own / (own + np.abs(x))

        solved = solve_ivp(
            flow, (0.0, 4.0), [0.0], method="LSODA", rtol=1e-9, atol=1e-12, dense_output=True
        )
        times = np.array([0.02, 0.1, 0.5, 1.0, 4.0])
        made = drawn("bergstrom_boyce", 0.3, share)[0]
        felt = at(held(made, REST + stretch, 4.0), *times)
        expected = 0.9 * K * (stretch - solved.sol(times)[0])
        np.testing.assert_allclose(felt, expected, atol=0.01 * 0.9 * K * abs(stretch))


@pytest.mark.parametrize("share", SHARES)
def test_a_rubber_relaxes_once_its_antioxidant_is_used_up(share):
    made, defining, draws = drawn("inhibited_oxidation", 0.2, share)
    assert not defining
    late, time = draws.at(0.15, 0.5) * LAST, draws.at(0.15, 0.6) * LAST
    # Chains are cut at a rate that rises as a logistic to one a time constant.
    t = np.arange(1, 4001) * SUBSTEP
    rates = 1.0 / (1.0 + np.exp(-5.0 * (t - 0.5 * SUBSTEP - late) / late)) / time
    lost = 1.0 - np.exp(-np.cumsum(rates) * SUBSTEP)
    felt = held(made, 3.0, LAST)
    np.testing.assert_allclose(felt, -0.2 * K * 3.0 * lost / lost[-1], atol=1e-4 * K)
    assert abs(felt[round(0.5 * late / SUBSTEP)]) < 0.05 * abs(felt[-1])


@pytest.mark.parametrize("share", SHARES)
def test_flags_have_the_corners_of_springs_that_yield(share):
    made, defining, draws = drawn("flag_loops", 0.5, share)
    assert not defining
    k, yielded = 0.5 * K, draws.at(0.06, 0.25) * TRAVEL
    after, returned = (
        draws.at(0.02, 0.2),
        (1.0 - draws.at(0.4, 0.9)) * draws.at(0.06, 0.25) * TRAVEL,
    )
    path = sweep(TOP, BOTTOM - 0.3, TOP, start=REST, points=4000)
    felt = resist(made, path)
    d = np.maximum(path - BOTTOM, 0.0)
    # A spring of the stiffness left, and one that slips at a constant force: corners in the place.
    up = k * (after * d + (1.0 - after) * np.minimum(d, yielded))
    down = k * (after * d + (1.0 - after) * np.minimum(d, returned))
    turned = up[4000] - k * (TOP - path)
    np.testing.assert_allclose(felt[:4001], up[:4001], atol=1e-9)
    np.testing.assert_allclose(felt[4001:8001], np.maximum(down, turned)[4001:8001], atol=1e-9)
    np.testing.assert_allclose(felt[8001:], up[8001:], atol=1e-9)
    assert (felt[path < BOTTOM] == 0.0).all()


@pytest.mark.parametrize("share", SHARES)
def test_surfaces_run_in_over_a_path_whatever_the_direction(share):
    made, defining, draws = drawn("running_in", 0.05, share)
    assert not defining
    lost, length = draws.at(0.4, 0.7), draws.at(0.1, 0.4) * UNEVEN.path
    speeds = UNEVEN.speed * np.repeat([3.0, -2.0, 0.5, -8.0], 1500)
    path = REST + np.cumsum(speeds) * SUBSTEP
    felt = resist(made, path)[1:]
    way = np.cumsum(np.abs(np.diff(path)))
    near = np.sin(np.arctan(speeds[1:] / (0.03 * UNEVEN.speed)))
    expected = 0.05 * FORCE * near * (1.0 - lost * (1.0 - np.exp(-way / length)))
    np.testing.assert_allclose(felt, expected, rtol=1e-6)


@pytest.mark.parametrize("share", SHARES)
def test_the_cone_s_coils_are_solid_one_after_the_other(share):
    """By a thousand short pieces in series, each of which gives way no further than its room."""
    made, defining, draws = drawn("conical_spring", 0.4, share)
    assert not defining
    narrow = draws.at(0.3, 0.6)
    radii = narrow + (1.0 - narrow) * (np.arange(4000) + 0.5) / 4000
    force = np.geomspace(1e-3, narrow**-3, 3000)
    depth = (1.0 - narrow) * np.minimum(force[:, None] * radii**3, 1.0).mean(axis=1)
    begun = 0.25 * (1.0 - narrow**4)
    at_top = begun + draws.at(0.5, 0.8) * (1.0 - narrow - begun)
    d = np.linspace(0.0, at_top, 300)
    added = np.interp(d, depth, force) - d / begun
    expected = np.where(d > begun, added, 0.0) * 0.4 * FORCE / added[-1]
    felt = resist(made, BOTTOM + TRAVEL * d / at_top)
    np.testing.assert_allclose(felt, expected, atol=2e-3 * 0.4 * FORCE)
    beyond = resist(made, np.linspace(TOP + 2.0 * TRAVEL, TOP + 3.0 * TRAVEL, 50))
    assert np.isfinite(beyond).all()
    np.testing.assert_allclose(np.diff(beyond, 2), 0.0, atol=1e-9 * beyond[-1])
    assert beyond[0] > felt[-1]


@pytest.mark.parametrize("share", SHARES)
def test_swings_count_by_their_power_above_the_limit_alone(share):
    order, limit = (
        drawn("endurance_limit", 0.1, share)[2].at(*ends) for ends in ((3.0, 6.0), (0.15, 0.35))
    )

    def lost(part, turns):
        made = drawn("endurance_limit", 0.1, share)[0]
        path = sweep(*[BOTTOM + part * TRAVEL, BOTTOM] * turns, start=BOTTOM, points=100)
        return -(resist(made, path) / (K * path))[150::200]

    assert (lost(0.9 * limit, 10) == 0.0).all()
    whole, half = lost(1.0, 10), lost(0.5, 10)
    np.testing.assert_allclose(np.diff(whole), np.diff(whole)[0], rtol=1e-9)
    assert np.diff(half)[0] / np.diff(whole)[0] == pytest.approx(0.5**order, rel=1e-6)
    # The sum over as many swings as are expected, with a Rayleigh distribution, is the size.
    mean = UNEVEN.path / (2.0 * UNEVEN.cycles * TRAVEL)
    swings = mean * np.sqrt(-4.0 / np.pi * np.log((np.arange(100_000) + 0.5) / 100_000))
    each = min(np.mean(np.where(swings > limit, swings, 0.0) ** order), 1.0)
    assert np.diff(whole)[0] == pytest.approx(0.1 / (UNEVEN.cycles * each), rel=0.01)


@pytest.mark.parametrize("share", SHARES)
def test_the_crack_s_spring_is_stiffer_on_one_side(share):
    made, defining, draws = drawn("breathing_crack", 0.3, share)
    frequency = draws.at(0.6, 2.0) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    pull, push = (forces_at(made, REST + d) for d in (1.0, -1.0))
    assert pull == pytest.approx(0.3 * K)
    ratio = draws.at(np.sqrt(1.5), 2.0) ** (2.0 * draws.side())
    assert -push / pull == pytest.approx(ratio)
    # Half a period on either side, as a mass alone on either spring has it.
    mass = made.constants[0]
    halves = [np.pi * np.sqrt(mass / spring) for spring in (pull, -push)]
    assert sum(halves) == pytest.approx(1.0 / frequency)
    # Its equation of motion, by another integrator.
    dashpot = made.constants[2]
    place = REST + 1.5

    def move(t, s):
        stretch, speed = place - s[0], -s[1]
        spring = pull if stretch > 0.0 else -push
        return [s[1], (spring * stretch + dashpot * speed) / mass]

    s = integrated(move, [REST, 0.0], 2.0, max_step=0.002, rtol=1e-8)
    stretch = place - s[0]
    expected = np.where(stretch > 0.0, pull, -push) * stretch - dashpot * s[1]
    felt = held(made, place, 2.0)[:-1]
    np.testing.assert_allclose(felt, expected, atol=0.05 * max(pull, -push) * 1.5)


def forces_at(law, y):
    """Return the force of a law at rest at a place."""
    return forces.total_force(forces.stack([law]), y, 0.0)


@pytest.mark.parametrize("share", SHARES)
def test_a_dent_stays_and_is_left_along_a_steeper_line(share):
    made, defining, draws = drawn("dented_stop", 0.3, share)
    place, stiffness = TOP - 0.3 * TRAVEL, draws.at(5.0, 20.0) * K
    assert defining == {"limit": pytest.approx(place)}
    deep, deeper = 0.1 * TRAVEL, 0.2 * TRAVEL
    path = sweep(
        place + deep, BOTTOM, place + deeper, BOTTOM, place + deep, start=REST, points=2000
    )
    felt, expected, largest = resist(made, path), [], 0.0
    for depth in path - place:
        largest = max(largest, depth)
        # From the largest depth the force falls so fast that a part of the depth is left.
        left = largest * (1.0 - 1.0 / draws.at(1.3, 3.0))
        steep = stiffness * largest / (largest - left) if largest > 0.0 else 0.0
        expected.append(max(steep * (depth - left), 0.0))
    np.testing.assert_allclose(felt, expected, atol=1e-9)
    assert felt[-1] < stiffness * deep


@pytest.mark.parametrize("share", SHARES)
def test_a_joint_s_springs_slip_with_segalman_s_density(share):
    made, defining, draws = drawn("bolted_joint", 0.5, share)
    assert not defining
    # A branch is that of springs which slip at twice their stretch.
    longest, order = 0.5 * draws.at(0.3, 0.9) * TRAVEL, draws.at(-0.8, -0.3)
    together = draws.at(0.0, 0.5)
    scale = (1.0 - together) * (1.0 + order) / longest ** (1.0 + order)

    def virgin(u):
        """The springs' force, by the density of the stretches at which they slip."""
        parts = [(0.0, min(u, longest)), (min(u, longest), longest)]
        slipped = quad(lambda s: s, *parts[0], weight="alg", wvar=(order, 0.0))[0]
        holding = u * scale * quad(lambda s: s**order, *parts[1])[0]
        return 0.5 * K * (scale * slipped + holding + together * min(u, longest))

    path = sweep(9.0, 2.0, 6.0, start=REST)
    felt = resist(made, path)
    for k in (10, 50, 200, 400):
        assert felt[k] == pytest.approx(virgin(path[k] - REST), rel=1e-6)
    assert felt[400] - felt[800] == pytest.approx(2.0 * virgin(3.5), rel=1e-6)
    assert felt[1000] - felt[800] == pytest.approx(2.0 * virgin(1.0), rel=1e-6)
    # Loops take energy as a power of the swing: the property that the density was chosen for.
    taken = []
    for swing in (0.1 * longest, 0.2 * longest):
        path = sweep(*[REST + swing, REST - swing] * 2, start=REST, points=4000)
        felt = resist(drawn("bolted_joint", 0.5, share)[0], path)
        loop = slice(4000, 12_001)
        taken.append(np.trapezoid(felt[loop], path[loop]))
    assert np.log2(taken[1] / taken[0]) == pytest.approx(3.0 + order, abs=0.01)


@pytest.mark.parametrize("share", SHARES)
def test_an_iron_is_magnetised_as_another_integrator_says(share):
    made, defining, draws = drawn("jiles_atherton", 0.5, share)
    assert not defining
    shape, pins = draws.at(0.1, 0.3) * TRAVEL, draws.at(0.05, 0.2) * TRAVEL
    mean_field, reversible = draws.at(0.3, 0.8) * shape, draws.at(0.05, 0.2)
    middle = BOTTOM + draws.at(0.3, 0.7) * TRAVEL

    def langevin(x):
        return 1.0 / np.tanh(x) - 1.0 / x

    # By the effective field of Jiles and Atherton as the path: place = field - mean field * M.
    def slope(field, m, side):
        free = langevin(field / shape)
        reversed_slope = (langevin((field + 1e-4) / shape) - free) / 1e-4
        return max(side * (free - m), 0.0) / pins + reversible * reversed_slope

    def along(place, m, side):
        inner = slope(place - middle + mean_field * m, m, side)
        return inner / (1.0 - mean_field * inner)

    path = sweep(9.0, 1.0, 6.0, 4.5, start=REST, points=1000)
    start = brentq(lambda m: m - langevin((REST - middle + mean_field * m) / shape), -1.0, 1.0)
    m, expected = start, [np.array([start])]
    for first in range(0, 4000, 1000):
        ways = path[first + 1 : first + 1001]
        side = np.sign(ways[-1] - path[first])
        solved = solve_ivp(
            lambda way, m, y=path[first], side=side: [side * along(y + side * way, m[0], side)],
            (0.0, abs(ways[-1] - path[first])), [m], t_eval=np.abs(ways - path[first]),
            max_step=0.02, rtol=1e-7,
        )  # fmt: skip
        expected.append(solved.y[0])
        m = expected[-1][-1]
    force = 0.5 * K * (3.0 * shape - mean_field)
    found = resist(made, path)
    np.testing.assert_allclose(found, -force * np.concatenate(expected), atol=2e-3 * force)
    # Where no pin holds it attracts as a spring of the size would, near the middle.
    free = [brentq(lambda m, h=h: m - langevin((h + mean_field * m) / shape), -1.0, 1.0)
            for h in (-0.01 * shape, 0.01 * shape)]  # fmt: skip
    assert force * (free[1] - free[0]) / (0.02 * shape) == pytest.approx(0.5 * K, rel=1e-3)


@pytest.mark.parametrize("share", SHARES)
def test_tensions_on_either_side_of_a_post_are_in_euler_s_ratio(share):
    made, defining, draws = drawn("belt_around_post", 0.05, share)
    assert not defining
    wound, growth = draws.at(0.15, 0.4), draws.at(0.2, 0.6)
    stacked = forces.stack([made])
    fast = 1e4 * UNEVEN.speed
    for part in (0.0, 0.5, 1.0):
        place = BOTTOM + part * TRAVEL
        ahead, back = (forces.total_force(stacked, place, v) for v in (fast, -fast))
        # Of dT = T dθ, integrated in ten thousand small pieces of the angle.
        pulled = (1.0 + wound / 10_000) ** 10_000
        load = 0.05 * FORCE * (1.0 + growth * (part - 0.5)) * 2.0 / (pulled - 1.0 / pulled)
        assert ahead == pytest.approx(load * (pulled - 1.0), rel=1e-3)
        assert back == pytest.approx(-load * (1.0 - 1.0 / pulled), rel=1e-3)
    # It resists, and no load pushes: a slack belt has no friction.
    assert forces.total_force(stacked, BOTTOM - 10.0 * TRAVEL, fast) == 0.0
    slow = forces.total_force(stacked, BOTTOM + 0.5 * TRAVEL, 0.03 * UNEVEN.speed)
    near = np.exp(wound * np.sin(0.25 * np.pi)) - 1.0
    assert slow == pytest.approx(0.05 * FORCE * near / np.sinh(wound), rel=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_gears_rub_more_once_in_a_period_whatever_the_direction(share):
    made, defining, draws = drawn("uneven_gears", 0.05, share)
    assert not defining
    depth, period = draws.at(0.3, 0.7), draws.at(0.05, 0.3) * TRAVEL
    stacked = forces.stack([made])
    places = BOTTOM + np.linspace(0.0, 2.0 * period, 2001)
    ahead, back = (
        np.array([forces.total_force(stacked, y, v * 1e4 * UNEVEN.speed) for y in places])
        for v in (1.0, -1.0)
    )
    np.testing.assert_allclose(back, -ahead, rtol=1e-9)
    np.testing.assert_allclose(ahead[1000:], ahead[:1001], atol=1e-6 * FORCE)
    # One line of the spectrum beside the mean.
    lines = np.abs(np.fft.rfft(ahead[:-1])) / 1000.0
    assert lines[0] == pytest.approx(2.0 * 0.05 * FORCE, rel=1e-6)
    assert lines[2] == pytest.approx(depth * 0.05 * FORCE, rel=1e-6)
    assert np.delete(lines, [0, 2]).max() < 1e-6 * FORCE
    turned = np.sin(draws.at(0.0, 2.0 * np.pi))
    assert ahead[0] == pytest.approx(0.05 * FORCE * (1.0 + depth * turned), rel=1e-5)


@pytest.mark.parametrize("share", SHARES)
def test_a_leaf_is_bent_as_its_guide_allows(share):
    made, defining, draws = drawn("guided_leaf", 0.4, share)
    assert not defining
    touched, beyond = draws.at(0.0, 0.3), draws.at(0.3, 0.45)
    # A leaf of length 1 is bent by its moment, by no more than the guide; touched at force 1.
    s = (np.arange(20_000) + 0.5) / 20_000
    force = np.geomspace(1.0, 12.0, 400)
    bent = np.minimum(force[:, None] * (1.0 - s), 1.0) @ (1.0 - s) / s.size
    x = bent / bent[0]
    y = BOTTOM + TRAVEL * (touched + (1.0 - touched) * (x - 1.0) / beyond)
    added = force - x
    expected = 0.4 * FORCE * added / np.interp(1.0 + beyond, x, added)
    inside = x < 1.0 + beyond
    np.testing.assert_allclose(resist(made, y[inside]), expected[inside], atol=1e-3 * FORCE)
    below = np.linspace(BOTTOM - TRAVEL, BOTTOM + touched * TRAVEL, 50)
    np.testing.assert_allclose(resist(made, below), 0.0, atol=1e-9)
    beyond_top = resist(made, np.linspace(TOP + 2.0 * TRAVEL, TOP + 3.0 * TRAVEL, 50))
    np.testing.assert_allclose(np.diff(beyond_top, 2), 0.0, atol=1e-9 * beyond_top[-1])
    assert beyond_top[0] > expected[inside][-1]


@pytest.mark.parametrize("share", SHARES)
def test_damage_comes_with_the_largest_stroke_and_with_all_strokes(share):
    made, defining, draws = drawn("two_damages", 0.2, share)
    assert not defining
    part = draws.at(0.3, 0.7)
    path = sweep(*[TOP, REST] * 3, 7.0, REST, TOP + 2.0, REST, start=REST, points=200)
    energy = 0.5 * K * (path - REST) ** 2
    largest = np.maximum.accumulate(energy)
    changes = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(energy)))])

    def lost(work, whole):
        scale = draws.at(0.3, 1.0) * whole
        return (1.0 - np.exp(-work / scale)) / (1.0 - np.exp(-whole / scale))

    whole = 0.5 * K * TRAVEL * UNEVEN.path
    first = lost(largest, 0.5 * K * (TOP - REST) ** 2)
    expected = 0.2 * (part * first + (1.0 - part) * lost(changes, whole))
    np.testing.assert_allclose(resist(made, path), -K * path * expected, rtol=1e-9)
    # A large damage leaves a tenth.
    made = drawn("two_damages", 5.0, share)[0]
    assert resist(made, sweep(TOP, start=REST))[-1] == pytest.approx(-0.9 * K * TOP)
