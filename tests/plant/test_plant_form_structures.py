"""Hidden forces of pores, leaves, bonds, beams, absorbers and buffers, by other statements."""

from itertools import pairwise

import numpy as np
import pytest
from made_conditions import held, integrated, resist, steady, sweep
from made_draws import SHARES, UNEVEN, drawn, form
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from dea.plant import forces
from dea.plant.film import SUBSTEP

K, TRAVEL, TIME, REST = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.time, UNEVEN.rest
BOTTOM, TOP, LENGTH = UNEVEN.bottom, UNEVEN.top, UNEVEN.duration
SPEED = UNEVEN.path / LENGTH
EACH = pytest.mark.parametrize("share", SHARES)
ANGULAR = 2.0 * np.pi / TIME


@EACH
def test_a_fluid_leaves_pores_as_it_diffuses(share):
    made, draws = form("biphasic_layer", 0.3, share)
    slowest = draws.log(2.0, 20.0) * TIME
    felt = held(made, REST + 2.0, 4.0)
    t = np.arange(1, felt.size + 1) * SUBSTEP
    # Mow's layer, pressed at once: equal parts that relax with squares, by the rule of images.
    late = t > 0.05 * slowest
    theta = np.exp(-np.outer(t / slowest, np.arange(1, 400) ** 2)).sum(axis=1)
    at_one = np.exp(-TIME / slowest * np.arange(1, 400) ** 2).sum()
    np.testing.assert_allclose(felt[late], 0.3 * K * 2.0 * theta[late] / at_one, rtol=2e-3)
    # Where it is early, it falls with the root of time: half of √(π slowest/t), less one half.
    image = 0.5 * np.sqrt(np.pi * slowest / t) - 0.5
    early = (t > 0.03 * slowest) & (t < 0.3 * slowest)
    np.testing.assert_allclose(theta[early], image[early], rtol=1e-3)


@EACH
def test_free_volume_makes_the_clock_of_all_elements_quicker(share):
    quicker = 2.0 + 3.0 * share
    length = (0.3 + 0.7 * share) * TRAVEL
    times = 10.0 ** np.linspace(-0.5, 2.0, 6) * TIME
    for stretch in (-2.0, 0.5, 6.0):
        felt = held(form("free_volume", 0.3, share)[0], REST + stretch, 2.0)
        x = max(stretch, 0.0) / length
        rate = np.exp(quicker * (1.0 - 1.0 / (1.0 + x)))
        t = np.arange(1, felt.size + 1) * SUBSTEP
        left = np.exp(-np.outer(t * rate, 1.0 / times)).sum(axis=1)
        expected = 0.3 * K * stretch * left / np.exp(-TIME / times).sum()
        np.testing.assert_allclose(felt, expected, rtol=1e-9)


def lost(name, share, size=0.2):
    """Return the share of the stiffness that is lost with time, and the draws."""
    made, draws = form(name, size, share)
    return -held(made, 3.0, LENGTH) / (3.0 * K), draws


@EACH
def test_a_fractional_element_loses_mittag_leffler_s_function(share):
    found, draws = lost("fractional_maxwell", share)
    order, time = draws.at(0.45, 0.8), draws.at(0.05, 0.5) * LENGTH
    assert found[-1] == pytest.approx(0.2, rel=1e-6)

    def left(t):
        # By its integral over rates (F. Mainardi).
        def part(r):
            return (
                np.exp(-r * t / time)
                * r ** (order - 1.0)
                / (r ** (2.0 * order) + 2.0 * r**order * np.cos(order * np.pi) + 1.0)
            )

        whole = quad(lambda u: part(np.exp(u)) * np.exp(u), -25.0, 25.0, limit=400)[0]
        return np.sin(order * np.pi) / np.pi * whole

    times = np.array([0.02, 0.1, 0.3, 0.6, 1.0]) * LENGTH
    expected = np.array([1.0 - left(t) for t in times])
    at = found[np.rint(times / SUBSTEP).astype(int) - 1]
    np.testing.assert_allclose(at / 0.2, expected / expected[-1], atol=0.01)


@EACH
def test_relaxation_runs_by_a_clock_that_swings(share):
    found, draws = lost("swinging_temperature", share)
    time, frequency = draws.at(0.2, 0.8) * LENGTH, draws.at(2.0, 4.0) / LENGTH
    phase, depth = draws.at(0.0, 2.0 * np.pi), draws.at(0.6, 0.95)
    t = np.arange(1, found.size + 1) * SUBSTEP
    # Its rate over what is left is that of the clock.
    scale = brentq(
        lambda s: -np.log(1.0 - found[-1] / s) * time
        - quad(lambda t: 1.0 + depth * np.sin(2.0 * np.pi * frequency * t + phase), 0, LENGTH)[0],
        0.2001, 20.0,
    )  # fmt: skip
    rate = np.gradient(found, SUBSTEP) / (scale - found) * time
    expected = 1.0 + depth * np.sin(2.0 * np.pi * frequency * t + phase)
    np.testing.assert_allclose(rate[5:-5], expected[5:-5], atol=0.02)
    assert found[-1] == pytest.approx(0.2, rel=1e-6)
    assert (np.diff(found) > 0.0).all()


@EACH
def test_leaves_approach_a_steep_line_upwards_and_a_flat_one_downwards(share):
    made, draws = form("leaf_spring", 0.8, share)
    start = BOTTOM - draws.at(0.1, 0.4) * TRAVEL
    friction, length = draws.at(0.15, 0.4), draws.at(0.05, 0.2) * TRAVEL
    path = sweep(TOP, BOTTOM, 0.5 * (TOP + BOTTOM), points=4000, start=REST)
    felt = resist(made, path)

    def course(side):
        return lambda y, f: (
            side * (0.8 * K * (1.0 + side * friction) * max(y - start, 0.0) - f) / length
        )

    f, ends = 0.8 * K * max(REST - start, 0.0), [0, 4000, 8000, 12_000]
    for first, last in pairwise(ends):
        side = np.sign(path[last] - path[first])
        solved = solve_ivp(
            course(side), (path[first], path[last]), [f], t_eval=path[first : last + 1],
            rtol=1e-9, atol=1e-9, max_step=0.05,
        )  # fmt: skip
        np.testing.assert_allclose(felt[first + 1 : last + 1], solved.y[0][1:], atol=2e-3 * K)
        f = solved.y[0][-1]
    # The loop is the wider the larger the load.
    up, down = felt[:4000], felt[4000:8000][::-1]
    inside = (path[:4000] > BOTTOM + 4.0 * length) & (path[:4000] < TOP - 2.5 * length)
    if np.count_nonzero(inside) > 100:
        width = (up - np.interp(path[:4000], path[4000:8000][::-1], down))[inside]
        assert width[-1] > width[0]


@EACH
def test_concrete_heads_from_no_force_to_its_largest_stroke(share):
    made, draws = form("cracked_concrete", 1.0, share)
    yielding, kept = draws.at(0.08, 0.3) * TRAVEL, draws.at(0.02, 0.2)

    def skeleton(d):
        return K * (min(d, yielding) + kept * max(d - yielding, 0.0))

    far, back, small = 2.5 * yielding, -1.5 * yielding, 0.2 * yielding
    turns = [far, back, far, small, 3.0 * yielding]
    path = sweep(*[REST + d for d in turns], points=6000, start=REST)
    felt, d = resist(made, path), path - REST
    peak, other = skeleton(far), -skeleton(1.5 * yielding)
    # Corners of its course, by Takeda's rules (and Clough's straight lines to the peak).
    empty = far - peak / K
    gone = back - other / K
    pieces = [
        ([0.0, yielding, far], [0.0, K * yielding, peak]),
        # Down: without force at ``empty``, then to the yield point on the other side, and beyond.
        ([far, empty, -yielding, back], [peak, 0.0, -K * yielding, other]),
        # Up: without force at ``gone``, then to the first peak.
        ([back, gone, far], [other, 0.0, peak]),
        # Down again: heading for the largest stroke downwards.
        ([far, empty, back], [peak, 0.0, other]),
    ]
    for k, (places, values) in enumerate(pieces):
        piece = slice(6000 * k + 1, 6000 * (k + 1) + 1)
        order = np.argsort(places)
        expected = np.interp(d[piece], np.array(places)[order], np.array(values)[order])
        np.testing.assert_allclose(felt[piece], expected, atol=5e-3 * peak)
    assert felt[-1] == pytest.approx(skeleton(3.0 * yielding), rel=1e-6)


@EACH
def test_bonds_break_at_more_than_they_slide_with(share):
    made, draws = form("breaking_bonds", 0.05, share)
    sliding = 0.05 * K * TRAVEL
    stretch, more = draws.at(0.003, 0.02) * TRAVEL, 1.0 + draws.at(0.15, 0.5)
    path = sweep(REST + 4.0 * stretch, REST - 4.0 * stretch, points=8000, start=REST)
    felt, way = resist(made, path), np.abs(np.diff(path, prepend=path[0]))
    stiffness = sliding * more / stretch
    first = np.arange(8001) * way[5]
    expected = np.where(first < stretch, stiffness * first, sliding)
    near = np.abs(first - stretch) < 2.0 * way[5]
    np.testing.assert_allclose(felt[:8001][~near], expected[~near], rtol=1e-6, atol=1e-9)
    assert felt[:8001].max() == pytest.approx(more * sliding, rel=2e-3)
    # On the way back it falls from sliding to the break on the other side.
    back = np.arange(1, 8001) * way[9000]
    broken = (sliding + more * sliding) / stiffness
    expected = np.where(back < broken, sliding - stiffness * back, -sliding)
    near = np.abs(back - broken) < 2.0 * way[9000]
    np.testing.assert_allclose(felt[8001:][~near], expected[~near], rtol=1e-6, atol=1e-6)


@EACH
def test_a_brake_fades_by_its_own_heat_and_cools(share):
    made, draws = form("fading_brake", 0.05, share)
    part, cooling = draws.at(0.5, 0.9), draws.at(2.0, 10.0) * TIME
    for v in SPEED * np.array([-2.0, 0.3, 1.0]):
        for seconds in (0.05, 3.0):
            heat = abs(v) / SPEED * (1.0 - np.exp(-seconds / cooling))
            shape = np.sin(np.arctan(v / (0.03 * SPEED)))
            expected = 0.05 * K * TRAVEL * (1.0 - part * heat / (1.0 + heat)) * shape
            assert steady(made, [v], seconds)[0] == pytest.approx(expected, rel=1e-9)


D = np.linspace(0.0, 1.3, 1301) * TRAVEL


@EACH
@pytest.mark.parametrize("size", [0.1, 3.0])
def test_nested_springs_are_met_one_after_the_other(share, size):
    made, draws = form("nested_springs", size, share)
    met = [(third + draws.at(0.3, 0.9)) / 3.0 for third in range(3)]
    # By the work of each, half its stiffness times the square of its way.
    work = sum(0.5 * np.maximum(D / TRAVEL - place, 0.0) ** 2 for place in met)
    felt = resist(made, BOTTOM + D)
    whole = sum(1.0 - place for place in met)
    expected = size * K * TRAVEL * np.gradient(work, D / TRAVEL) / whole
    np.testing.assert_allclose(felt[1:-1], expected[1:-1], atol=2e-3 * size * K * TRAVEL)
    assert felt[1000] == pytest.approx(size * K * TRAVEL)


@EACH
def test_a_worm_like_chain_has_marko_and_siggia_s_force(share):
    made, draws = form("worm_like_chain", 0.7, share)
    length = draws.at(1.1, 1.4) * TRAVEL

    def chain(x):
        return 0.25 / (1.0 - x) ** 2 - 0.25 + x

    felt = resist(made, BOTTOM + D)
    x = D / length
    inside = x < 0.949
    # Less the line of its first stiffness, 3/2.
    expected = chain(x[inside]) - 1.5 * x[inside]
    expected *= 0.7 * K * TRAVEL / (chain(TRAVEL / length) - 1.5 * TRAVEL / length)
    np.testing.assert_allclose(felt[inside], expected, atol=1e-9 * K * TRAVEL)
    beyond = np.diff(felt[x > 0.951])
    if beyond.size > 1:
        np.testing.assert_allclose(beyond, beyond[0], rtol=1e-9)


@EACH
def test_a_filler_breaks_with_the_path_and_joins_with_time(share):
    size = 0.3
    made, draws = form("filler_network", size, share)
    path, joined = draws.at(0.1, 0.5) * UNEVEN.path, draws.at(0.2, 1.0) * LENGTH
    moving = np.where(np.arange(8000) < 4000, SPEED, 0.0)

    def contacts(t, m):
        return moving[min(int(t / SUBSTEP), 7999)] * (1.0 - m) / path - m / joined

    y = np.cumsum(moving) * SUBSTEP
    stacked, found = forces.stack([made]), []
    for v, place in zip(moving, y, strict=True):
        forces.update_memory(stacked, place, v, SUBSTEP)
        found.append(-forces.total_force(stacked, 3.0, v) / (3.0 * K))
    solved = solve_ivp(contacts, (0.0, 8.0), [0.0], max_step=0.01, rtol=1e-8, dense_output=True)
    broken = solved.sol(np.arange(1, 8001) * SUBSTEP)[0]
    # Of a steady motion as long as the record ``size`` is lost.
    np.testing.assert_allclose(found, size * broken / broken[3999], atol=2e-3 * size)
    assert found[3999] == pytest.approx(size, rel=1e-6)


@EACH
def test_a_force_fades_with_the_way_whatever_the_time(share):
    made, draws = form("endochronic", 0.8, share)
    length = draws.at(0.03, 0.1) * TRAVEL
    ends = [REST, TOP, BOTTOM, 0.5 * (TOP + BOTTOM)]
    path = sweep(*ends[1:], points=1000, start=REST)
    felt = resist(made, path)
    # Each piece of the way adds its stiffness, of which a share is left after what follows.
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path)))])
    middle = 0.5 * (way[1:] + way[:-1])
    for k in (300, 1000, 1400, 2000, 2900):
        since = way[k] - middle[:k]
        left = sum(
            stiffness * np.exp(-since / (length * longer))
            for stiffness, longer in ((4.0 / 7.0, 1.0), (2.0 / 7.0, 3.0), (1.0 / 7.0, 9.0))
        )
        expected = 0.8 * K * (left @ np.diff(path)[:k])
        assert felt[k] == pytest.approx(expected, abs=1e-3 * K)
    slow = resist(form("endochronic", 0.8, share)[0], path[::10], seconds_each=0.05)
    np.testing.assert_allclose(slow, felt[::10], atol=1e-9)


@EACH
def test_strands_break_as_weibull_s_law_says(share):
    made, draws = form("breaking_strands", 0.2, share)
    order, scale = draws.at(2.0, 4.0), draws.at(0.4, 0.8) * UNEVEN.full_cycles
    path = sweep(*[TOP, BOTTOM] * 16, start=BOTTOM, points=60)
    felt = resist(made, path)
    lost = -felt / (K * path)
    # Each swing counts as half a cycle, when the next one is longer than a tenth of the travel.
    cycles = 0.5 * np.arange(1, 30)
    after = lost[60 * np.arange(2, 31)]
    left = 1.0 - np.exp(-((cycles / scale) ** order))
    whole = 1.0 - np.exp(-((UNEVEN.full_cycles / scale) ** order))
    np.testing.assert_allclose(after, 0.2 * left / whole, rtol=1e-6)


@EACH
def test_damage_comes_slowly_and_then_quickly(share):
    made, draws = form("two_phases", 0.2, share)
    knee, early = draws.at(0.3, 0.7) * UNEVEN.full_cycles, draws.at(0.1, 0.25)
    path = sweep(*[TOP, BOTTOM] * 16, start=BOTTOM, points=60)
    lost = -resist(made, path) / (K * path)
    cycles, after = 0.5 * np.arange(1, 30), lost[60 * np.arange(2, 31)]
    # A line from none to the knee, and one from there to all at the end, which it goes beyond.
    line = np.array([0.0, knee, UNEVEN.full_cycles]), np.array([0.0, early, 1.0])
    np.testing.assert_allclose(after, 0.2 * np.interp(cycles, *line), rtol=1e-6)


@EACH
def test_an_absorber_that_rubs_stops_within_a_finite_time(share):
    made, defining, draws = drawn("rubbing_absorber", 0.1, share)
    frequency = draws.at(0.6, 2.0) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    angular, spring = 2.0 * np.pi * frequency, 0.1 * K
    dry = draws.at(0.01, 0.04) * TRAVEL  # over the spring
    stretch = 0.3 * TRAVEL
    felt = held(made, REST + stretch, 6.0 / frequency)

    def move(t, s):
        rub = angular**2 * dry * s[1] / np.hypot(s[1], 0.01 * angular * TRAVEL)
        return [s[1], -(angular**2) * s[0] - 0.02 * angular * s[1] - rub]

    x, w = integrated(move, [-stretch, 0.0], 6.0 / frequency)
    rub = dry * w / np.hypot(w, 0.01 * angular * TRAVEL)
    expected = spring * (-x - 0.02 * w / angular - rub)
    np.testing.assert_allclose(felt[: expected.size], expected, atol=0.02 * spring * stretch)
    # Of rubbing alone each period takes four times the friction over the spring.
    assert np.abs(x[-1]) < max(stretch - 20.0 * dry, dry)


@EACH
def test_an_absorber_of_three_elements_rings_at_its_frequency(share):
    made, defining, draws = drawn("three_elements", 0.1, share)
    frequency = draws.at(0.6, 2.0) / TIME
    assert defining == {"frequency": pytest.approx(frequency)}
    part, relaxed = draws.at(0.1, 0.4), draws.at(0.3, 1.5)
    felt = held(made, REST + 1.0, 5.0 / frequency)
    # The mass of unit spring and mass, by a matrix whose complex pair has the frequency.
    matrix = np.array(
        [[0.0, 1.0, 0.0], [-1.0 - part, 0.0, part], [1.0 / relaxed, 0.0, -1.0 / relaxed]]
    )
    values, vectors = np.linalg.eig(matrix)
    pace = 2.0 * np.pi * frequency / np.abs(values[np.argmax(values.imag)])
    parts = np.linalg.solve(vectors, [-1.0, 0.0, 0.0])
    t = np.arange(1, felt.size + 1) * SUBSTEP
    x, _, given = (vectors @ (parts[:, None] * np.exp(np.outer(values, pace * t)))).real
    # Places are counted from the held one: the dashpot begins at -1 of it, as the mass does.
    expected = 0.1 * K * (-x + part * (given - x))
    np.testing.assert_allclose(felt, expected, atol=0.02 * 0.1 * K)


PLACE = TOP - 0.4 * TRAVEL


@EACH
def test_a_buffer_of_wedges_pushes_less_on_the_way_back(share):
    made, defining, draws = drawn("friction_buffer", 0.4, share)
    assert defining == {"limit": pytest.approx(PLACE)}
    stiffness, kept = draws.at(8.0, 25.0) * K, draws.at(0.2, 0.5)
    deep, up = 0.3 * TRAVEL, 0.1 * TRAVEL
    path = sweep(PLACE + deep, PLACE + up, PLACE + deep, PLACE - up, points=4000, start=PLACE - up)
    felt = resist(made, path)
    d = path - PLACE

    def line(k):
        return d[4000 * k + 1 : 4000 * (k + 1) + 1]

    np.testing.assert_allclose(felt[1:4001], stiffness * np.maximum(line(0), 0.0), atol=1e-6)
    back = np.maximum(stiffness * (deep - 3.0 * (deep - line(1))), kept * stiffness * line(1))
    np.testing.assert_allclose(felt[4001:8001], back, atol=1e-6 * K * TRAVEL)
    again = np.minimum(stiffness * (kept * up + 3.0 * (line(2) - up)), stiffness * line(2))
    np.testing.assert_allclose(felt[8001:12_001], again, atol=1e-6 * K * TRAVEL)
    left = np.maximum(stiffness * (deep - 3.0 * (deep - line(3))), kept * stiffness * line(3))
    np.testing.assert_allclose(felt[12_001:], np.maximum(left, 0.0), atol=1e-6 * K * TRAVEL)


@EACH
def test_a_pad_creeps_under_a_load_and_comes_back(share):
    made, defining, draws = drawn("creeping_pad", 0.4, share)
    assert defining == {"limit": pytest.approx(PLACE)}
    lasting, ratio = draws.at(4.0, 10.0) * K, draws.at(2.0, 4.0)
    time, depth = draws.at(0.2, 2.0) * TIME, 0.2 * TRAVEL
    path = PLACE + depth * np.repeat([-1.0, 1.0, -1.0, 1.0], [100, 3000, 200, 500])
    felt = resist(made, path)
    t = np.arange(1, 3001) * SUBSTEP
    # Of what is pressed at once all but a share is gone in the end.
    held_on = lasting * depth * (1.0 + (ratio - 1.0) * np.exp(-t / time))
    np.testing.assert_allclose(felt[100:3100], held_on, rtol=1e-6)
    assert (felt[3100:3300] == 0.0).all()
    given = (1.0 - np.exp(-3.0 / time)) * np.exp(-0.2 / time)
    left = (1.0 - given) * np.exp(-t[:500] / time)
    again = lasting * depth * (1.0 + (ratio - 1.0) * left)
    np.testing.assert_allclose(felt[3300:], again, rtol=1e-6)


@EACH
def test_a_tapered_pin_damps_by_a_power_of_the_place(share):
    made, draws = form("tapered_dashpot", 0.5, share)
    stacked = forces.stack([made])
    dashpot = 0.5 * K / ANGULAR
    for place in (-0.2, 0.0, 0.5, 1.0, 1.2, 1.4):
        y = BOTTOM + place * TRAVEL
        wide = min(max(place, 0.0), 1.2) ** draws.at(2.0, 4.0)
        felt = [forces.total_force(stacked, y, v) for v in (-3.0, 2.0)]
        np.testing.assert_allclose(felt, dashpot * wide * np.array([-3.0, 2.0]), atol=1e-9)
