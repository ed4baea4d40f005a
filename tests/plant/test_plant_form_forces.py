"""Hidden forces, against what the literature says of their laws."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, at, bend, built, held, resist, steady, sweep
from scipy.integrate import solve_ivp
from scipy.special import erf

from dea.plant import forces
from dea.plant.film import SUBSTEP
from dea.plant.force_laws.friction import ageing_friction, carry_age
from dea.plant.hidden import EFFECTS

K, TRAVEL, TOP = CONDITIONS.stiffness, CONDITIONS.travel, CONDITIONS.top
HYSTERESIS = [form.name for form in EFFECTS["rate_independent_hysteresis"].forms]
FRICTION = [form.name for form in EFFECTS["coulomb_friction"].forms]
STIFFENING = [form.name for form in EFFECTS["strain_stiffening"].forms]
SOFTENING = [form.name for form in EFFECTS["cyclic_softening"].forms]
STOPS = [form.name for form in EFFECTS["end_stop"].forms]


def relaxation(form, seconds, size=0.3, y=1.0):
    """Return the force while a stretch is held, for a step at time 0."""
    return held(built("viscoelastic_creep", form, size)[0], y, seconds)


@pytest.mark.parametrize(
    "form",
    [
        "spring_pot",
        "stretched_exponential",
        "fractional_zener",
        "logarithmic_creep",
        "standard_linear_solid",
    ],
)
def test_a_spectrum_has_its_size_after_one_band_period_and_is_linear(form):
    felt = relaxation(form, 1.0)
    assert felt[-1] == pytest.approx(0.3 * K, rel=1e-6)
    np.testing.assert_allclose(relaxation(form, 1.0, y=2.0), 2.0 * felt, rtol=1e-9)


def test_the_spring_pot_relaxes_as_a_power_of_time():
    times = np.array([0.1, 1.0, 10.0, 100.0])
    slopes = np.diff(np.log(at(relaxation("spring_pot", 100.0), *times))) / np.diff(np.log(times))
    assert (slopes < -0.08).all()
    assert np.ptp(slopes) < 0.12


def test_the_stretched_exponential_s_logarithm_is_a_power_of_time():
    times = np.array([0.5, 2.0, 8.0, 32.0])
    felt = relaxation("stretched_exponential", 32.0)
    whole = built("viscoelastic_creep", "stretched_exponential", 0.3)[0].constants[1::2].sum()
    orders = np.diff(np.log(-np.log(at(felt, *times) / whole))) / np.diff(np.log(times))
    assert ((orders > 0.38) & (orders < 0.72)).all()
    assert np.ptp(orders) < 0.05


def test_logarithmic_creep_loses_the_same_each_decade():
    felt = relaxation("logarithmic_creep", 10.0)
    lost = -np.diff(at(felt, 0.5, 1.0, 2.0, 4.0))
    np.testing.assert_allclose(lost, lost.mean(), rtol=0.15)


def test_the_activated_dashpot_is_the_solution_of_eyring_s_equation():
    from scipy.integrate import solve_ivp

    law = built("viscoelastic_creep", "activated_dashpot", 0.3)[0]
    stiffness, rate, length = law.constants
    solved = solve_ivp(
        lambda t, x: rate * np.sinh((5.0 - x) / length), (0.0, 3.0), [0.0], rtol=1e-9, atol=1e-12,
        method="LSODA", dense_output=True,
    )  # fmt: skip
    times = np.array([0.01, 0.1, 1.0, 3.0])
    expected = stiffness * (5.0 - solved.sol(times)[0])
    np.testing.assert_allclose(at(held(law, 5.0, 3.0), *times), expected, rtol=1e-3)


@pytest.mark.parametrize("form", [form.name for form in EFFECTS["stress_relaxation"].forms])
def test_relaxation_takes_its_share_by_the_end_whatever_moves(form):
    law = built("stress_relaxation", form, 0.1)[0]
    felt = held(law, 5.0, CONDITIONS.duration)
    assert felt[-1] == pytest.approx(-0.1 * K * 5.0, rel=1e-3)
    assert (np.diff(felt) <= 1e-12).all()
    assert abs(felt[0]) < 2e-2 * abs(felt[-1])


def test_the_courses_of_relaxation_are_what_their_names_say():
    times = np.linspace(1.0, 60.0, 40)
    lost = {
        form: -at(held(built("stress_relaxation", form, 0.1)[0], 1.0, 60.0), *times)
        for form in ("hyperbolic_relaxation", "logarithmic_relaxation", "power_relaxation")
    }
    # Peleg: time over loss is a straight line in time.
    quotient = times / lost["hyperbolic_relaxation"]
    line = np.polyval(np.polyfit(times, quotient, 1), times)
    np.testing.assert_allclose(quotient, line, rtol=1e-3)
    # ln(1 + t/T): the inverse of its rate is a straight line in time; a power's is one at a power.
    inverse = 1.0 / np.gradient(lost["logarithmic_relaxation"], times)[2:-2]
    line = np.polyval(np.polyfit(times[2:-2], inverse, 1), times[2:-2])
    np.testing.assert_allclose(inverse, line, rtol=0.02)
    rate = np.gradient(lost["power_relaxation"], times)[2:-2]
    exponents = np.linspace(0.05, 0.8, 151)
    bends = [bend(times[2:-2], rate ** (-1.0 / (1.0 + n))) for n in exponents]
    assert min(bends) < 2e-3
    assert 0.08 < exponents[int(np.argmin(bends))] < 0.6


@pytest.mark.parametrize("form", HYSTERESIS)
def test_hysteresis_does_not_depend_on_rate(form):
    slow = resist(built("rate_independent_hysteresis", form, 1.0)[0], sweep(9, 3, 10, points=4000))
    quick = resist(built("rate_independent_hysteresis", form, 1.0)[0], sweep(9, 3, 10, points=200))
    np.testing.assert_allclose(slow[::20], quick, atol=0.02 * np.abs(slow).max())


@pytest.mark.parametrize("form", HYSTERESIS)
def test_hysteresis_takes_energy_around_a_loop(form):
    path = sweep(10, 2, 10, 2, 10, points=600)
    felt = resist(built("rate_independent_hysteresis", form, 1.0)[0], path)
    loop = slice(1800, 3001)
    assert np.trapezoid(felt[loop], path[loop]) > 0.0


@pytest.mark.parametrize(
    "form",
    ["masing_loops", "menegotto_pinto", "ramberg_osgood", "bolted_joint", "preisach_product"],
)
def test_reversals_are_remembered_and_smaller_ones_wiped_out(form):
    outer = resist(built("rate_independent_hysteresis", form, 1.0)[0], sweep(10, 2, 7))
    path = sweep(10, 2, 6, 4, 5.5, 4.5, 7)
    inner = resist(built("rate_independent_hysteresis", form, 1.0)[0], path)
    assert inner[-1] == pytest.approx(outer[-1], rel=1e-9)


def test_preisach_s_loops_between_the_same_ends_are_congruent():
    path = sweep(10, 4, 6, 4, 9, 2, 4, 6, 4)
    felt = resist(built("rate_independent_hysteresis", "preisach_product", 1.0)[0], path)
    first, second = felt[1200:1601], felt[3200:3601]  # both turn at 6 and fall to 4
    np.testing.assert_allclose(first - first[0], second - second[0], atol=1e-9)


def test_preisach_s_branch_counts_the_relays_that_have_switched():
    """Against relays one by one, with a Lorentzian density in both thresholds; they let go."""
    law = built("rate_independent_hysteresis", "preisach_product", 1.0)[0]
    height, middle, width = law.constants
    grid = np.tan(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 402)[1:-1])  # equal shares of a Lorentzian
    share = (np.pi / 401) ** 2 * height
    down, up = np.meshgrid(middle + width * grid, middle + width * grid)
    path = sweep(10, 2, 8, 5, points=200)
    felt = resist(law, path)[200:]
    state = np.where(up <= 10.0, 1.0, -1.0)
    counted = []
    for y in path[200:]:
        state = np.where(up <= y, 1.0, np.where(down >= y, -1.0, state))
        counted.append(0.5 * share * state[up > down].sum())
    change = counted[0] - np.array(counted)
    np.testing.assert_allclose(felt - felt[0], change, atol=0.02 * np.ptp(change))


def test_the_bouc_wen_deflection_saturates_and_starts_with_its_stiffness():
    law = built("rate_independent_hysteresis", "bouc_wen", 1.5)[0]
    felt = resist(law, sweep(10.0, -10.0, points=4000))
    limit = 1.5 * K * law.constants[1]
    assert felt[10] / (10 * 10.0 / 4000) == pytest.approx(1.5 * K, rel=0.02)
    assert felt[4000] == pytest.approx(limit, rel=0.01)
    assert felt[-1] == pytest.approx(-limit, rel=0.01)


def test_coleman_and_hodgdon_s_branches_end_on_parallel_lines():
    law = built("rate_independent_hysteresis", "coleman_hodgdon", 1.0)[0]
    path = sweep(80.0, -80.0, 80.0, points=8000)
    felt = resist(law, path)
    slopes = np.gradient(felt, path)
    rate, slope, own, _ = law.constants
    up, down = slopes[7500:7900], slopes[15500:15900]
    np.testing.assert_allclose(up, slope, rtol=0.01)
    np.testing.assert_allclose(down, slope, rtol=0.01)
    # A straight line that is followed at rate a is led by (g - b)/a on either side.
    ahead = felt[7900] - slope * path[7900]
    assert ahead == pytest.approx((own - slope) / rate, rel=0.02)


@pytest.mark.parametrize("form", FRICTION)
def test_friction_opposes_sliding_with_about_its_force(form):
    sliding = 0.05 * K * TRAVEL
    felt = resist(built("coulomb_friction", form, 0.05)[0], sweep(10, 1, points=1000))
    forward, back = felt[500:990].mean(), felt[1500:1990].mean()
    assert forward == pytest.approx(sliding, rel=0.35)
    assert back == pytest.approx(-sliding, rel=0.35)


def test_dahl_s_force_is_an_exponential_of_the_place():
    law = built("coulomb_friction", "dahl", 0.05)[0]
    limit, stiffness = law.constants
    path = sweep(1.0, points=2000)
    felt = resist(law, path)
    np.testing.assert_allclose(felt, -limit * np.expm1(-stiffness * path / limit), atol=1e-9)


def test_lugre_holds_more_than_it_slides_with():
    law = built("coulomb_friction", "lugre", 0.05, seed=3)[0]
    force = steady(law, np.geomspace(0.05, 1e3, 25), seconds=20.0)
    sliding, static = law.constants[2:4]
    assert force[0] == pytest.approx(static, rel=0.01)
    assert force[-1] == pytest.approx(sliding, rel=0.01)
    assert (np.diff(force) <= 1e-9).all()


def test_stribeck_s_curve_falls_exponentially_to_sliding():
    law = built("coulomb_friction", "stribeck_curve", 0.05)[0]
    sliding, _, speed, fine = law.constants
    speeds = np.linspace(20 * fine, 5 * speed, 50)
    excess = steady(law, speeds) - sliding
    order = np.polyfit(speeds, np.log(excess + 1e-300), 1)
    assert order[0] == pytest.approx(-1.0 / speed, rel=0.05)
    np.testing.assert_allclose(steady(law, -speeds), -steady(law, speeds))


def test_makkar_s_friction_is_smooth_peaks_and_differs_with_the_direction():
    law = built("coulomb_friction", "makkar", 0.05)[0]
    speeds = np.linspace(0.0, 40.0, 4001)
    ahead, back = steady(law, speeds), steady(law, -speeds)
    assert ahead[0] == 0.0
    peak = int(np.argmax(ahead))
    assert 0 < peak < 2000
    assert ahead[peak] > 1.03 * ahead[-1]
    uneven = law.constants[5]
    assert ahead[-1] / -back[-1] == pytest.approx((1 + uneven) / (1 - uneven), rel=1e-3)


@pytest.mark.parametrize("form", STIFFENING)
def test_stiffening_grows_faster_than_any_line_to_its_size_at_the_top(form):
    path = np.linspace(CONDITIONS.bottom, TOP, 200)
    felt = resist(built("strain_stiffening", form, 0.5)[0], path)
    assert (np.diff(felt, 2) > -1e-12).all()
    assert felt[-1] == pytest.approx(0.5 * K * TRAVEL, rel=1e-6)
    assert felt[100] < 0.3 * felt[-1]


def test_stiffening_follows_its_publication():
    path = np.linspace(CONDITIONS.bottom, TOP, 400)[1:]
    d = path - CONDITIONS.bottom
    felt = {form: resist(built("strain_stiffening", form, 0.5)[0], path) for form in STIFFENING}
    # Ogden's term: a straight line between logarithms.
    order = np.polyfit(np.log(d), np.log(felt["ogden_term"]), 1)[0]
    assert 3.5 <= order <= 6.0
    assert bend(np.log(d), np.log(felt["ogden_term"])) < 1e-6
    # Fung's exponential: the third derivative over the second is a constant.
    second = np.diff(felt["fung"], 2)
    np.testing.assert_allclose(second[1:] / second[:-1], second[1] / second[0], rtol=1e-4)
    # Gent: stretch over total stress is a parabola with its limit at 1.15 to 1.5 travels.
    law = built("strain_stiffening", "gent", 0.5)[0]
    spring = law.constants[0]
    parabola = d / (felt["gent"] / spring + d)
    fit = np.polyfit(d, parabola, 2)
    assert fit[1:] == pytest.approx([0.0, 1.0], abs=1e-6)
    assert 1.15 <= np.sqrt(-1.0 / fit[0]) / TRAVEL <= 1.5
    # Chain: the extension is Langevin's function of the force, to Cohen's five percent.
    law = built("strain_stiffening", "langevin_chain", 0.5)[0]
    spring, length = law.constants[:2]
    x = d / length
    tension = 3.0 * (felt["langevin_chain"] / (spring * length) + x)
    langevin = 1.0 / np.tanh(tension) - 1.0 / tension
    np.testing.assert_allclose(langevin, x, rtol=0.05)


@pytest.mark.parametrize("form", SOFTENING)
def test_softening_grows_with_motion_and_not_with_time(form):
    law = built("cyclic_softening", form, 0.2)[0]
    assert held(law, 5.0, 2.0)[-1] == pytest.approx(held(law, 5.0, 1.0)[-1])
    felt = resist(law, sweep(*[11, 1] * 20, 6, points=100))
    middle = felt[50:-100:100]
    assert abs(middle[-1]) >= abs(middle[1]) > 0.0
    assert (felt <= 1e-12).all()


def test_cycles_are_lost_as_a_power_and_as_a_logarithm():
    counts = np.arange(1, 30)
    lost = {}
    for form in ("power_of_cycles", "logarithm_of_cycles"):
        felt = resist(
            built("cyclic_softening", form, 0.2)[0], sweep(*[11, 1] * 30, start=1.0, points=50)
        )
        lost[form] = -felt[110::100][: counts.size] / (K * sweep(11, start=1.0, points=50)[10])
    power = lost["power_of_cycles"]
    assert bend(np.log(counts), np.log(power)) < 0.02
    assert 0.25 <= np.polyfit(np.log(counts), np.log(power), 1)[0] <= 0.6
    logarithm = lost["logarithm_of_cycles"]
    assert bend(counts, 1.0 / np.gradient(logarithm, counts)) < 0.1


def test_mullins_unloading_follows_the_error_function():
    law = built("cyclic_softening", "ogden_roxburgh", 0.2)[0]
    path = sweep(10, 1, points=500)
    felt = resist(law, path)
    assert np.abs(felt[:500]).max() < 1e-9  # the virgin curve is not softened
    _, share, m, beta = law.constants
    # As Ogden and Roxburgh's m is: a fraction of the work of the largest stroke.
    assert 0.05 <= m / (0.5 * K * TOP**2) <= 0.3
    work = 0.5 * K * path[500:] ** 2
    most = 0.5 * K * 100.0
    expected = -K * path[500:] * share * erf((most - work) / (m + beta * most))
    np.testing.assert_allclose(felt[500:], expected, atol=1e-9)


def test_damage_is_a_hyperbola_of_the_work():
    law = built("cyclic_softening", "damage_by_work", 0.2)[0]
    path = sweep(*[10, 0] * 20, 5, points=200)
    felt = resist(law, path)
    at_five = np.arange(1, 40) * 200 + 100
    lost = -felt[at_five] / (K * path[at_five])
    work = K * (25.0 / 2 + 50.0 * np.arange(1, 40) + np.where(np.arange(1, 40) % 2, 25.0, 0.0))
    assert bend(1.0 / work, 1.0 / lost) < 0.02
    # All of it is 0.2; a half is lost by a tenth to six tenths of the work of the whole motion, in
    # which the mean force is half that of the travel.
    slope, inverse = np.polyfit(1.0 / work, 1.0 / lost, 1)
    assert 1.0 / inverse == pytest.approx(0.2, rel=0.01)
    assert 0.1 < slope / inverse / (0.5 * K * TRAVEL * CONDITIONS.path) < 0.6


@pytest.mark.parametrize("form", [form.name for form in EFFECTS["second_mode"].forms])
def test_the_second_mass_rings_at_its_frequency(form):
    law, defining = built("second_mode", form, 0.1)
    felt = held(law, CONDITIONS.rest + 1e-3, 20.0)
    lines = np.abs(np.fft.rfft(felt - felt[-5000:].mean(), 16 * felt.size))
    found = np.fft.rfftfreq(16 * felt.size, SUBSTEP)[int(np.argmax(lines))]
    assert found == pytest.approx(defining["frequency"], rel=0.05)


def test_a_grounded_dashpot_exerts_no_force_on_the_first_mass():
    grounded = built("second_mode", "grounded_damper", 0.1)[0]
    attached = built("second_mode", "hardening_absorber", 0.1)[0]
    for law, quiet in ((grounded, True), (attached, False)):
        stacked = forces.stack([law])
        push = forces.total_force(stacked, CONDITIONS.rest, 1.0)
        assert (push == 0.0) == quiet


def test_springs_of_the_second_mass_harden_or_soften():
    far = 2.0 * TRAVEL
    for form, harder in (("hardening_absorber", True), ("sloshing_pendulum", False)):
        stacked = forces.stack([built("second_mode", form, 0.1)[0]])
        stiffness = forces.total_force(stacked, far, 0.0) / far
        assert (stiffness > 0.1 * K) == harder


@pytest.mark.parametrize("form", STOPS)
@pytest.mark.parametrize("seed", range(3))
def test_a_stop_is_felt_beyond_its_place_alone_and_never_pulls(form, seed):
    law, defining = built("end_stop", form, 0.4, seed)
    path = np.linspace(CONDITIONS.bottom, TOP, 2001)
    felt = resist(law, np.concatenate([path, path[::-1]]), seconds_each=0.01)
    place = TOP - 0.4 * TRAVEL
    assert defining["limit"] == pytest.approx(place)
    assert (felt[:2001][path < place - 1e-9] == 0.0).all()
    assert (felt >= 0.0).all()
    assert felt[2000] > 0.3 * K * TRAVEL


def test_stops_press_as_their_names_say():
    depth = np.linspace(0.01, 0.3, 60)
    path = TOP - 0.4 * TRAVEL + depth

    def pressed(form):
        stacked = forces.stack([built("end_stop", form, 0.4)[0]])
        return np.array([forces.total_force(stacked, y, 0.0) for y in path])

    hertz, sprung = pressed("hertz_contact"), pressed("sprung_contact")
    assert np.polyfit(np.log(depth), np.log(hertz), 1)[0] == pytest.approx(1.5, abs=1e-3)
    assert np.polyfit(np.log(depth), np.log(sprung), 1)[0] == pytest.approx(1.0, abs=1e-3)
    rubber = np.diff(pressed("rubber_bumper"))  # exponential: equal ratios
    np.testing.assert_allclose(rubber[1:] / rubber[:-1], rubber[1] / rubber[0], rtol=1e-6)
    law = built("end_stop", "air_cushion", 0.4)[0]
    stiffness, _, length = law.constants
    pressure = 1.0 + 1.4 * pressed("air_cushion") / (stiffness * length)
    volume = 1.0 - depth / length
    np.testing.assert_allclose(pressure * volume**1.4, 1.0, rtol=1e-9)


def test_a_moving_hertz_stop_presses_harder_while_it_closes():
    stacked = forces.stack([built("end_stop", "hertz_contact", 0.4, seed=1)[0]])
    y = TOP - 0.39 * TRAVEL
    closing, still, opening = (forces.total_force(stacked, y, v) for v in (5.0, 0.0, -5.0))
    assert closing > still > opening >= 0.0


def test_contacts_age_at_rest_and_are_renewed_by_slip():
    """Dieterich's law of ageing, a' = 1 - |v| a/L, by another integrator."""
    slip, dt = 0.3, 1e-3
    constants, memory = np.array([1.0, 0.1, 0.2, slip, 0.05]), np.zeros(4)
    speeds = np.repeat([0.0, 2.0, 0.0, -0.5, 0.1], 400)
    found = []
    for v in speeds:
        carry_age(constants, memory, 0.0, v, dt)
        found.append(memory[0])
    age = np.zeros(1)
    expected = []
    for v in speeds:
        age = solve_ivp(lambda t, a, v=v: 1.0 - abs(v) * a / slip, (0, dt), age, rtol=1e-9).y[:, -1]
        expected.append(age[0])
    np.testing.assert_allclose(found, expected, atol=2e-3)
    # Friction after a long rest over that of new contacts: 1 + 0.1 log(1 + a/0.2).
    rested = ageing_friction(constants, np.array([4.0]), 0.0, 10.0)
    fresh = ageing_friction(constants, np.zeros(1), 0.0, 10.0)
    assert rested / fresh == pytest.approx(1.0 + 0.1 * np.log(21.0))
