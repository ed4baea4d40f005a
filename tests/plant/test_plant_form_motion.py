"""Further hidden forces, against what the literature says of their laws."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, held, resist, steady, sweep
from scipy.integrate import solve_ivp
from scipy.stats import norm

from dea.plant import forces
from dea.plant.film import SUBSTEP

K, TRAVEL, BOTTOM, TOP = (
    CONDITIONS.stiffness, CONDITIONS.travel, CONDITIONS.bottom, CONDITIONS.top
)  # fmt: skip


def at(felt, *times):
    return np.array([felt[round(time / SUBSTEP) - 1] for time in times])


def test_the_linear_solid_relaxes_at_one_rate():
    felt = held(built("viscoelastic_creep", "standard_linear_solid", 0.3)[0], 1.0, 20.0)[::500]
    np.testing.assert_allclose(felt[1:] / felt[:-1], felt[1] / felt[0], rtol=1e-9)
    assert 1.5 <= -0.5 / np.log(felt[1] / felt[0]) <= 20.0


@pytest.mark.parametrize("seed", range(3))
def test_the_power_dashpot_is_the_solution_of_norton_s_equation(seed):
    law = built("viscoelastic_creep", "norton_dashpot", 0.3, seed)[0]
    stiffness, rate, length, order = law.constants
    solved = solve_ivp(
        lambda t, x: rate * ((5.0 - x) / length) ** order, (0.0, 3.0), [0.0], rtol=1e-9,
        atol=1e-12, method="LSODA", dense_output=True,
    )  # fmt: skip
    times = np.array([0.01, 0.1, 1.0, 3.0])
    expected = stiffness * (5.0 - solved.sol(times)[0])
    np.testing.assert_allclose(at(held(law, 5.0, 3.0), *times), expected, rtol=1e-3)
    law = built("viscoelastic_creep", "norton_dashpot", 0.3, seed)[0]
    np.testing.assert_allclose(at(held(law, -5.0, 3.0), *times), -expected, rtol=1e-3)


def test_quasi_linear_relaxation_is_a_product_of_stretch_and_time():
    felt = {
        y: held(built("viscoelastic_creep", "quasi_linear", 0.3)[0], y, 20.0) for y in (2, 4, 8)
    }
    np.testing.assert_allclose(felt[4] / felt[4][0], felt[2] / felt[2][0], rtol=1e-9)
    # Of an exponential, f(2d)/f(d) - 2 = f(d)/length: it doubles with f(d).
    excess = [felt[4][0] / felt[2][0] - 2.0, felt[8][0] / felt[4][0] - 2.0]
    assert excess[1] / excess[0] == pytest.approx(felt[4][0] / felt[2][0], rel=1e-6)
    top = held(built("viscoelastic_creep", "quasi_linear", 0.3)[0], TOP, 1.0)
    assert top[-1] == pytest.approx(0.3 * K * TOP, rel=2e-3)
    left = felt[4][::500]
    roots = np.roots(
        [1.0, *-np.linalg.lstsq(np.column_stack([left[1:-1], left[:-2]]), left[2:])[0]]
    )
    times = np.sort(-0.5 / np.log(roots))
    assert 0.4 <= times[0] <= 2.0
    assert 8.0 <= times[1] <= 40.0


def lost(form):
    return -held(built("stress_relaxation", form, 0.1)[0], 1.0, CONDITIONS.duration)


def test_further_courses_of_relaxation_are_what_their_names_say():
    times = np.arange(1, 61) - SUBSTEP
    seconds = slice(999, None, 1000)
    rate = np.diff(lost("maxwell_relaxation")[seconds])
    np.testing.assert_allclose(rate[1:] / rate[:-1], rate[1] / rate[0], rtol=1e-6)
    # A draining gel begins with the root of time.
    early = lost("draining_gel")[10:60]
    order = np.polyfit(np.log(np.arange(10, 60) + 1.0), np.log(early), 1)[0]
    assert order == pytest.approx(0.5, abs=0.02)
    # Avrami: ln(-ln(1 - share)) is a straight line in the logarithm of time, for the right whole.
    crystal = lost("crystallising_rubber")[seconds]
    bends = []
    for whole in crystal[-1] * np.geomspace(1.0 + 1e-6, 1.5, 400):
        plotted = np.log(-np.log1p(-crystal[5:-1] / whole))
        line = np.polyfit(np.log(times[5:-1]), plotted, 1)
        bends.append((np.abs(plotted - np.polyval(line, np.log(times[5:-1]))).max(), line[0]))
    bend, order = min(bends)
    assert bend < 0.02
    assert 1.95 <= order <= 3.55


def test_stops_obey_masing_s_rule_and_close_their_loops():
    path = sweep(9, 3, 9, points=600)
    felt = resist(built("rate_independent_hysteresis", "prandtl_stops", 1.0)[0], path)
    virgin, down, up = felt[:600], felt[600:1201], felt[1200:1801]
    # A branch is the virgin curve at twice its size (G. Masing, 1926): from rest, 0 to 3 doubles.
    along = np.linspace(0.0, 3.0, 200, endpoint=False)
    doubled = 2.0 * np.interp(along, path[:600], virgin)
    branch = down[0] - np.interp(2.0 * along, 9.0 - path[600:1201], down)
    np.testing.assert_allclose(branch, doubled, atol=1e-2 * doubled.max())
    assert up[-1] == pytest.approx(down[0], rel=1e-9)
    assert virgin[5] / path[5] == pytest.approx(K, rel=1e-6)
    kinks = np.count_nonzero(np.abs(np.diff(felt[:500], 2)) > 1e-4 * K)
    assert 5 <= kinks <= 12


def test_the_ring_spring_s_loop_is_a_triangle():
    path = sweep(9, 1, 9, points=4000)
    felt = resist(built("rate_independent_hysteresis", "ring_spring", 1.0)[0], path)
    up, down = felt[2000:4000] / path[2000:4000], felt[6500:8000] / path[6500:8000]
    np.testing.assert_allclose(up, up[0], rtol=1e-9)
    np.testing.assert_allclose(down, -up[0], rtol=1e-9)
    assert 0.05 * K <= up[0] <= 0.25 * K
    turning = np.gradient(felt, path)[4002:4100]
    np.testing.assert_allclose(turning, K, rtol=1e-6)


def test_blocks_slip_one_after_the_other():
    law = built("coulomb_friction", "maxwell_slip", 0.05)[0]
    felt = resist(law, sweep(1.0, -1.0, points=4000))
    sliding = 0.05 * K * TRAVEL
    assert felt[3999] == pytest.approx(sliding, rel=1e-9)
    assert felt[-1] == pytest.approx(-sliding, rel=1e-9)
    slopes = np.unique(np.round(np.diff(felt[:4000]) / (1.0 / 4000), 3))
    assert 4 <= slopes.size <= 9
    # All have slipped back after twice the largest stretch.
    assert felt[4000 + round(0.062 * TRAVEL * 2000)] == pytest.approx(-sliding, rel=1e-9)
    assert felt[4000 + round(0.055 * TRAVEL * 2000)] > -sliding


def test_contacts_strengthen_with_the_logarithm_of_rest_and_renew_by_slip():
    def start(seconds):
        stacked = forces.stack([built("coulomb_friction", "ageing_contacts", 0.05)[0]])
        for _ in range(round(seconds / SUBSTEP)):
            forces.update_memory(stacked, 0.0, 0.0, SUBSTEP)
        return forces.total_force(stacked, 0.0, 1e3)

    rises = np.diff([start(seconds) for seconds in (1.0, 4.0, 16.0)])
    assert rises[1] == pytest.approx(rises[0], rel=0.02)
    assert rises[0] > 0.05 * 0.05 * K * TRAVEL
    law = built("coulomb_friction", "ageing_contacts", 0.05)[0]
    speeds = np.array([20.0, 200.0])
    sliding, growth, time, slip, fine = law.constants
    expected = sliding * (1.0 + growth * np.log1p(slip / speeds / time))
    expected *= speeds / np.hypot(speeds, fine)
    np.testing.assert_allclose(steady(law, speeds, 1.0), expected, rtol=0.01)


def test_the_bearing_s_friction_grows_with_the_place_alone():
    stacked = forces.stack([built("coulomb_friction", "loaded_bearing", 0.05)[0]])
    places = np.linspace(BOTTOM, TOP, 30)
    quick, slow = (
        np.array([forces.total_force(stacked, y, v) for y in places]) for v in (100.0, -20.0)
    )
    np.testing.assert_allclose(np.diff(quick, 2), 0.0, atol=1e-9)
    np.testing.assert_allclose(-slow, quick, rtol=1e-3)
    assert quick.mean() == pytest.approx(0.05 * K * TRAVEL, rel=1e-3)
    assert quick[-1] > 1.8 * quick[0]


def stiffening(form, path):
    return resist(built("strain_stiffening", form, 0.5)[0], path)


def test_further_stiffening_follows_its_publication():
    d = np.linspace(0.0, TRAVEL, 401)[1:]
    # Hart-Smith: ln(1 + F/(c d)) is a parabola in d without a constant.
    felt = stiffening("hart_smith", BOTTOM + d)
    cubes = felt / d**3  # c (1 + x²/2 + x⁴/6 + ...): its start is c
    scale = np.polyval(np.polyfit(d[20:120] ** 2, np.log(cubes[20:120]), 3), 0.0)
    length = np.sqrt(0.5 / np.polyfit(d[20:120] ** 2, np.log(cubes[20:120]), 3)[-2])
    expected = np.exp(scale) * length**2 * d * np.expm1((d / length) ** 2)
    np.testing.assert_allclose(felt[20:200], expected[20:200], rtol=0.02)
    # Fibres: the second derivative of the force is the Gaussian of where they become taut.
    felt = stiffening("recruited_fibres", BOTTOM + d)
    density = np.diff(felt, 2)
    places = d[1:-1]
    logarithm = np.log(density[density > 1e-3 * density.max()])
    np.testing.assert_allclose(np.diff(logarithm, 3), 0.0, atol=1e-4)
    assert 0.5 <= places[np.argmax(density)] / TRAVEL <= 0.75
    law = built("strain_stiffening", "recruited_fibres", 0.5)[0]
    stiffness, mean, width = law.constants
    waves = norm.ppf((np.arange(4000) + 0.5) / 4000, mean, width)
    counted = [stiffness * np.maximum(y - waves, 0.0).mean() for y in BOTTOM + d[::40]]
    np.testing.assert_allclose(felt[::40], counted, atol=1e-3 * felt[-1])
    # Cables: the way that each is longer times its tension, by the energy of a linear spring.
    law = built("strain_stiffening", "taut_cables", 0.5)[0]
    stiffness, span, _ = law.constants
    energy = 0.5 * stiffness * (np.hypot(d, span) - span) ** 2
    np.testing.assert_allclose(
        stiffening("taut_cables", BOTTOM + d)[1:-1], np.gradient(energy, d)[1:-1], atol=1e-3
    )


def softened(form, turns, size=0.2):
    """Return the share of the stiffness that is lost at each passage upwards."""
    felt = resist(
        built("cyclic_softening", form, size)[0], sweep(*[11, 1] * turns, start=1.0, points=50)
    )
    return -felt[110::100][: turns - 1] / (K * sweep(11, start=1.0, points=50)[10])


def test_cycles_saturate_exponentially_and_a_crack_grows_ever_faster():
    share = softened("saturating_cycles", 30)
    rate = np.diff(share)
    np.testing.assert_allclose(rate[1:] / rate[:-1], rate[1] / rate[0], rtol=1e-6)
    assert share[-1] == pytest.approx(0.2, rel=0.06)
    law = built("cyclic_softening", "paris_crack", 0.2)[0]
    crack = softened("paris_crack", 15)
    assert (np.diff(crack, 2) > 0.0).all()
    # Against Paris' equation da/dN = a^(m/2), whose end is where the share is 0.2.
    _, _, whole, share, _, _, order = law.constants
    rate = 2.0 * share / (order - 2.0) / whole
    solved = solve_ivp(
        lambda n, a: rate * a ** (0.5 * order), (0.0, whole), [1.0], rtol=1e-9, dense_output=True
    )
    grown = solved.sol(np.append(np.arange(1, crack.size + 1), whole))[0] - 1.0
    np.testing.assert_allclose(crack, 0.2 * grown[:-1] / grown[-1], rtol=1e-3)


def test_a_smaller_swing_cracks_as_a_power_less():
    law = built("cyclic_softening", "paris_crack", 0.01)[0]
    small = -resist(law, sweep(*[8.5, 3.5] * 3, start=3.5, points=50))[120] / (K * 5.5)
    large = softened("paris_crack", 3, 0.01)[0]
    assert large / small == pytest.approx(2.0 ** law.constants[6], rel=0.1)


def test_what_the_largest_stroke_took_stays_lost():
    law = built("cyclic_softening", "largest_stroke", 0.2)[0]
    path = sweep(6, 0, 6, 10, 5, points=300)
    felt = resist(law, path)
    with np.errstate(invalid="ignore"):
        share = -felt / (K * path)
    np.testing.assert_allclose(share[301:590], share[300], rtol=1e-9)
    np.testing.assert_allclose(share[610:900], share[300], rtol=1e-9)
    assert (np.diff(share[901:1200]) > 0.0).all()
    _, most, stroke, _ = law.constants
    x = 10.0 / stroke
    assert share[-1] == pytest.approx(most * (1.0 - (1.0 - np.exp(-x)) / x))


def test_the_column_is_damped_by_the_square_of_the_speed():
    law = built("second_mode", "liquid_column", 0.1)[0]
    stacked = forces.stack([law])
    push = np.array([forces.total_force(stacked, 0.0, v) for v in (-2.0, 1.0, 2.0, 4.0)])
    assert push[0] == -push[2]
    square = push[[2, 3]] - push[1] * np.array([2.0, 4.0])
    assert square[1] / square[0] == pytest.approx(6.0)  # v² - v at 4 and at 2

    mass, spring, dashpot, drag = law.constants

    def motion(t, s):
        w = -s[1]
        return [s[1], (spring * (3.0 - s[0]) + dashpot * w + drag * w * abs(w)) / mass]

    times = np.arange(0.5, 5.0, 0.5)
    solved = solve_ivp(motion, (0.0, 5.0), [0.0, 0.0], rtol=1e-9, atol=1e-9, t_eval=times)
    expected = -mass * np.array([motion(0.0, s)[1] for s in solved.y.T]) * -1.0
    felt = at(held(law, 3.0, 5.0), *times)
    np.testing.assert_allclose(felt, expected, atol=0.03 * np.abs(expected).max())


def test_the_twin_masses_ring_at_two_frequencies():
    law, defining = built("second_mode", "twin_masses", 0.1)
    felt = held(law, CONDITIONS.rest + 1e-3, 40.0)
    lines = np.abs(np.fft.rfft((felt - felt[-5000:].mean()) * np.hanning(felt.size), 8 * felt.size))
    peaks = np.flatnonzero((lines[1:-1] > lines[:-2]) & (lines[1:-1] > lines[2:])) + 1
    strongest = np.sort(peaks[np.argsort(lines[peaks])[-2:]])
    found = np.fft.rfftfreq(8 * felt.size, SUBSTEP)[strongest]
    assert found[0] == pytest.approx(defining["frequency"], rel=0.03)
    assert 1.25 < found[1] / found[0] < 1.85


@pytest.mark.parametrize("seed", range(3))
def test_the_pad_has_two_slopes_and_the_discs_are_softest_before_they_are_flat(seed):
    depth = np.linspace(0.0, 1.5, 1501)
    path = TOP - 0.4 * TRAVEL + depth

    def slopes(form):
        stacked = forces.stack([built("end_stop", form, 0.4, seed)[0]])
        return np.diff([forces.total_force(stacked, y, 0.0) for y in path]) / 1e-3

    pad = slopes("stepped_pad")
    levels, counts = np.unique(np.round(pad, 4), return_counts=True)
    levels = levels[counts > 5]
    assert levels.size == 2
    assert 2.0 <= pad[0] / K <= 6.0
    assert 15.0 <= pad[-1] / K <= 40.0
    discs = slopes("disc_springs")
    flat = int(np.argmax(np.diff(discs))) + 1
    assert depth[flat] + 1e-3 >= 0.02 * TRAVEL
    assert depth[flat] <= 0.06 * TRAVEL + 1e-3
    # A cubic force: the slope is a parabola, least where the discs are flat.
    bend = np.diff(discs[: flat - 1], 2)
    np.testing.assert_allclose(bend, bend.mean(), rtol=1e-3, atol=1e-6)
    assert discs[flat - 2] == pytest.approx(discs[:flat].min(), abs=0.02 * discs[0])
    assert discs.min() > 0.0
