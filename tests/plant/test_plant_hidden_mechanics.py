"""Hidden stiffening, softening and second masses against a statement of each, draw by draw."""

import numpy as np
import pytest
from made_conditions import held, integrated, resist, sweep
from made_draws import SHARES, UNEVEN, drawn, form
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.special import erf
from scipy.stats import norm

from dea.plant import forces
from dea.plant.film import SUBSTEP

K, TRAVEL, TIME, REST = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.time, UNEVEN.rest
BOTTOM, TOP, CYCLES = UNEVEN.bottom, UNEVEN.top, UNEVEN.full_cycles
EACH = pytest.mark.parametrize("share", SHARES)
D = np.linspace(-0.2, 1.0, 2401)  # in travels above the bottom


def fung(d, draws):
    x = d / draws.at(0.2, 0.5)
    return np.exp(x) - 1.0 - x


def demiray(d, draws):
    x = np.maximum(d, 0.0) / draws.at(0.5, 1.0)
    return x * (np.exp(x**2) - 1.0)


def recruited_fibres(d, draws):
    places = np.linspace(-2.0, d[-1], 100_001)
    taut = norm.cdf(places, draws.at(0.5, 0.75), draws.at(0.06, 0.2))
    return np.interp(d, places, cumulative_trapezoid(taut, places, initial=0.0))


def taut_cables(d, draws):
    # The tension of a cable times the sine of its angle.
    d, half = np.maximum(d, 0.0), draws.at(0.5, 1.2)
    length = np.sqrt(d**2 + half**2)
    return (length - half) * d / length


def gent(d, draws):
    d, limit = np.maximum(d, 0.0), draws.at(1.15, 1.5)
    return d * d**2 / (limit**2 - d**2)


def langevin_chain(d, draws):
    # Cohen's quotient (3x - x³)/(1 - x²) less 3x is 2x³/(1 - x²).
    x = np.maximum(d, 0.0) / draws.at(1.1, 1.4)
    return x**3 / (1.0 - x**2)


STIFFENING = {
    "fung": fung,
    "ogden_term": lambda d, draws: np.maximum(d, 0.0) ** draws.at(3.5, 6.0),
    "demiray": demiray,
    "recruited_fibres": recruited_fibres,
    "taut_cables": taut_cables,
    "gent": gent,
    "langevin_chain": langevin_chain,
}


@pytest.mark.parametrize("name", STIFFENING)
@EACH
def test_a_stiffening_force_has_its_size_at_the_top(name, share):
    made, draws = form(name, 0.4, share)
    expected = STIFFENING[name](D, draws)
    expected *= 0.4 * K * TRAVEL / expected[-1]
    np.testing.assert_allclose(resist(made, BOTTOM + TRAVEL * D), expected, atol=1e-6 * K)


@EACH
def test_chains_near_their_limit_go_on_in_their_tangent_or_stay(share):
    made, draws = form("gent", 0.4, share)
    limit = draws.at(1.15, 1.5)
    d = np.linspace(0.99, 1.3, 200) * limit
    felt = resist(made, BOTTOM + TRAVEL * d)
    scale = 0.4 * K * TRAVEL / gent(np.ones(1), draws)[0]
    assert felt[0] == pytest.approx(scale * gent(d[:1], draws)[0], rel=1e-6)
    nudge = 1e-6 * limit
    before = gent(d[:1] - nudge, draws)[0]
    slope = scale * (gent(d[:1], draws)[0] - before) / nudge
    np.testing.assert_allclose(np.diff(felt) / np.diff(d), slope, rtol=1e-3)
    made, draws = form("langevin_chain", 0.4, share)
    limit = draws.at(1.1, 1.4)
    felt = resist(made, BOTTOM + TRAVEL * limit * np.array([0.98, 0.99, 1.2]))
    scale = 0.4 * K * TRAVEL / langevin_chain(np.ones(1), draws)[0]
    last = langevin_chain(0.99 * limit * np.ones(1), draws)[0]
    np.testing.assert_allclose(felt[1:], scale * last, rtol=1e-6)


def power_of_cycles(ratio, d):
    return ratio ** d.at(0.25, 0.6)


def saturating_cycles(ratio, d):
    steep = d.at(2.0, 6.0)
    return (1.0 - np.exp(-steep * ratio)) / (1.0 - np.exp(-steep))


def logarithm_of_cycles(ratio, d):
    return np.log(1.0 + 20.0 * ratio) / np.log(21.0)


@pytest.mark.parametrize("law", [power_of_cycles, saturating_cycles, logarithm_of_cycles])
@EACH
def test_stiffness_is_lost_with_the_number_of_cycles(law, share):
    for cycles, counted in ((CYCLES, CYCLES), (0.5, 1.0)):
        made, draws = form(law.__name__, 0.2, share, UNEVEN._replace(full_cycles=cycles))
        path = sweep(*[TOP, BOTTOM] * 20, start=BOTTOM, points=100)
        middle = np.arange(40) * 100 + 50
        # A swing counts when the next is longer than a tenth of the travel.
        ratio = 0.5 * np.arange(40) / counted
        lost = np.minimum(0.2 * law(ratio, draws), 0.9)
        found = -(resist(made, path) / (K * path))[middle]
        np.testing.assert_allclose(found, lost, atol=1e-9)


def test_a_loss_ends_at_nine_tenths():
    made, _ = form("power_of_cycles", 0.8, 1.0, UNEVEN._replace(full_cycles=2.0))
    path = sweep(*[TOP, BOTTOM] * 8, start=BOTTOM, points=100)
    assert resist(made, path)[-1] == pytest.approx(-0.9 * K * BOTTOM)


def test_smaller_swings_count_as_their_share_and_ripples_not_at_all():
    middle = BOTTOM + 0.5 * TRAVEL
    counted = []
    for reach in (1.0, 0.5, 0.11, 0.09):
        made, _ = form("logarithm_of_cycles", 0.2, 0.3)
        ends = [middle + 0.5 * reach * TRAVEL, middle - 0.5 * reach * TRAVEL]
        path = sweep(*ends * 10, middle, start=middle, points=100)
        lost = -resist(made, path)[-1] / (K * middle)
        counted.append(np.expm1(lost / 0.2 * np.log(21.0)) / 20.0 * CYCLES)
    # The first swing is half as long as the others; the last of the small ones has not ended.
    np.testing.assert_allclose(counted, [9.75, 0.5 * 9.75, 0.11 * 9.25, 0.0], atol=1e-6)


def of_narrow_band(order, swing, limit=0.0):
    """Return the mean of a power of a narrow band's swings above a limit, from their mean."""
    probabilities = (np.arange(200_000) + 0.5) / 200_000
    rayleigh = np.sqrt(-2.0 * np.log(probabilities))
    swings = swing * rayleigh / np.sqrt(0.5 * np.pi)
    return np.mean(np.where(swings > limit, swings, 0.0) ** order)


@EACH
@pytest.mark.parametrize("path_length", [150.0, 250.0, 400.0])
def test_a_crack_grows_by_paris_law_as_fast_as_the_band_makes_it(share, path_length):
    made, draws = form("paris_crack", 0.2, share, UNEVEN._replace(path=path_length))
    order, longer = draws.at(2.5, 4.0), draws.at(3.0, 8.0)
    each = min(of_narrow_band(order, path_length / (2.0 * UNEVEN.cycles * TRAVEL)), 1.0)
    turns = max(round(UNEVEN.cycles * each) - 1, 1)
    path = sweep(*[TOP, BOTTOM] * turns, start=BOTTOM, points=60)
    ratio = 0.5 * np.arange(2 * turns) / (UNEVEN.cycles * each)
    # da/dN is a power of the root of the length; from the first to the last of the cycles.
    rate = 2.0 / (order - 2.0) * (1.0 - longer ** (1.0 - 0.5 * order))
    grown = solve_ivp(
        lambda n, a: rate * a ** (0.5 * order), (0.0, 1.0), [1.0], t_eval=np.minimum(ratio, 1.0),
        rtol=1e-9,
    ).y[0]  # fmt: skip
    found = -(resist(made, path) / (K * path))[np.arange(2 * turns) * 60 + 30]
    np.testing.assert_allclose(found, 0.2 * (grown - 1.0) / (longer - 1.0), rtol=5e-3, atol=1e-9)


@EACH
@pytest.mark.parametrize("path_length", [150.0, 250.0, 400.0])
def test_swings_above_the_limit_take_their_size_over_the_band(share, path_length):
    made, draws = form("endurance_limit", 0.1, share, UNEVEN._replace(path=path_length))
    order, limit = draws.at(3.0, 6.0), draws.at(0.15, 0.35)
    each = min(of_narrow_band(order, path_length / (2.0 * UNEVEN.cycles * TRAVEL), limit), 1.0)
    path = sweep(*[TOP, BOTTOM] * 3, start=BOTTOM, points=60)
    found = -(resist(made, path) / (K * path))[np.arange(6) * 60 + 30]
    lost = np.minimum(0.1 * 0.5 * np.arange(6) / (UNEVEN.cycles * each), 0.9)
    np.testing.assert_allclose(found, lost, rtol=2e-3, atol=1e-12)


@EACH
@pytest.mark.parametrize("size", [0.3, 1.2])
def test_below_its_largest_stroke_the_film_is_softer_by_the_error_function(share, size):
    made, draws = form("ogden_roxburgh", size, share)
    path = sweep(5.0, -6.0, 3.0, 9.0, 1.0, start=0.1)
    work = 0.5 * K * path**2
    most = np.maximum.accumulate(work)
    width = draws.at(0.05, 0.3) * (0.5 * K * TOP**2 + most)
    expected = -K * path * min(size, 0.9) * erf((most - work) / width)
    np.testing.assert_allclose(resist(made, path), expected, atol=1e-9)


@EACH
def test_work_damages_as_a_hyperbola(share):
    made, draws = form("damage_by_work", 0.3, share)
    path = sweep(*[TOP, -2.0] * 20, start=REST, points=500)
    half = draws.at(0.1, 0.6) * 0.5 * K * UNEVEN.path * TRAVEL
    away = np.abs(path - REST)
    work = K * np.append(0.0, np.cumsum(0.5 * (away[1:] + away[:-1]) * np.abs(np.diff(path))))
    expected = -K * path * 0.3 * work / (work + half)
    np.testing.assert_allclose(resist(made, path), expected, atol=2e-3 * K)
    assert work[-1] > half


def at_start(law, y, v):
    """Return the force of a law before its masses have moved."""
    return forces.total_force(forces.stack([law]), y, v)


SECOND = {
    "hardening_absorber": lambda d: 0.0,
    "shared_damping": lambda d: d.at(0.3, 0.7),
    "grounded_damper": lambda d: 1.0,
    "sloshing_pendulum": lambda d: 0.0,
}


@pytest.mark.parametrize("name", SECOND)
@EACH
def test_a_second_mass_moves_as_another_integrator_says(name, share):
    slow = UNEVEN._replace(time=3.5)
    made, defining, draws = drawn(name, 0.3, share, slow)
    frequency, damping = draws.at(0.6, 2.0) / slow.time, draws.at(0.03, 0.12)
    length, grounded = draws.at(1.0, 3.0) * TRAVEL, SECOND[name](draws)
    assert defining == {"frequency": pytest.approx(frequency)}
    spring, angular = 0.3 * K, 2.0 * np.pi * frequency
    mass = spring / angular**2
    dashpot = 2.0 * damping * mass * angular

    def pull(stretch):
        if name == "sloshing_pendulum":
            return spring * length * np.sin(stretch / length)
        return spring * (stretch + stretch**3 / length**2)

    for y in (REST + 4.0, REST - 7.0):
        assert at_start(made, y, 0.0) == pytest.approx(pull(y - REST))
    moved = at_start(made, REST, 2.0)
    assert moved == pytest.approx(2.0 * (1.0 - grounded) * dashpot, abs=1e-12)
    place = REST + 5.0

    def move(t, s):
        force = pull(place - s[0]) - (1.0 - grounded) * dashpot * s[1]
        return [s[1], (force - grounded * dashpot * s[1]) / mass]

    y, v = integrated(move, [REST, 0.0], 6.0)
    expected = pull(place - y) - (1.0 - grounded) * dashpot * v
    felt = held(made, place, 6.0)[:-1]
    np.testing.assert_allclose(felt, expected, atol=5e-3 * np.abs(expected).max())


@EACH
def test_the_column_of_liquid_moves_as_another_integrator_says(share):
    slow = UNEVEN._replace(time=3.5)
    made, defining, draws = drawn("liquid_column", 0.3, share, slow)
    frequency, damping = draws.at(0.6, 2.0) / slow.time, draws.at(0.02, 0.06)
    assert defining == {"frequency": pytest.approx(frequency)}
    spring, angular = 0.3 * K, 2.0 * np.pi * frequency
    mass = spring / angular**2
    # In a swing of 0.3 travels the square takes as much as a dashpot of this share of the critical.
    phase = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    swing = 0.3 * TRAVEL * angular * np.cos(phase)
    drag = 2.0 * draws.at(0.1, 0.4) * mass * angular * np.mean(swing**2) / np.mean(abs(swing) ** 3)

    def resistance(w):
        return 2.0 * damping * mass * angular * w + drag * w * abs(w)

    for v in (-3.0, 8.0):
        assert at_start(made, REST + 1.0, v) == pytest.approx(spring + resistance(v), rel=1e-6)
    place = REST + 5.0

    def move(t, s):
        return [s[1], (spring * (place - s[0]) + resistance(-s[1])) / mass]

    y, v = integrated(move, [REST, 0.0], 6.0)
    expected = spring * (place - y) + resistance(-v)
    felt = held(made, place, 6.0)[:-1]
    np.testing.assert_allclose(felt, expected, atol=5e-3 * spring * 5.0)


@EACH
def test_twin_masses_move_side_by_side(share):
    slow = UNEVEN._replace(time=3.5)
    made, defining, draws = drawn("twin_masses", 0.3, share, slow)
    frequency = draws.at(0.6, 1.6) / slow.time
    assert defining == {"frequency": pytest.approx(frequency)}
    damping = draws.at(0.02, 0.06)
    times = np.arange(1, 6000) * SUBSTEP
    expected, quick = 0.0, 0.0
    for spring, rate in (
        (0.3 * K, frequency),
        (0.3 * draws.at(0.3, 0.6) * K, frequency * draws.at(1.3, 1.8)),
    ):
        angular = 2.0 * np.pi * rate
        ringing = angular * np.sqrt(1.0 - damping**2)
        decay = np.exp(-damping * angular * times)
        # The stretch of a damped oscillator that begins at rest, and its speed.
        stretch = 5.0 * decay * np.cos(ringing * times)
        stretch += 5.0 * decay * damping * angular / ringing * np.sin(ringing * times)
        speed = -5.0 * decay * angular**2 / ringing * np.sin(ringing * times)
        dashpot = 2.0 * damping * spring / angular
        expected = expected + spring * stretch + dashpot * speed
        quick += dashpot
    assert at_start(made, REST, 2.0) == pytest.approx(2.0 * quick)
    felt = held(made, REST + 5.0, 6.0)[:-1]
    np.testing.assert_allclose(felt, expected, atol=0.01 * np.abs(expected).max())


@EACH
def test_a_carried_mass_is_damped_against_the_one_that_carries_it(share):
    slow = UNEVEN._replace(time=3.5)
    made, defining, draws = drawn("masses_in_series", 0.3, share, slow)
    frequency, damping = draws.at(0.6, 1.6) / slow.time, draws.at(0.02, 0.06)
    assert defining == {"frequency": pytest.approx(frequency)}
    spring, carried, pace = 0.3 * K, draws.at(0.1, 0.5), draws.at(0.8, 1.6)
    # In units of the first mass on its spring; then its time is as the lower frequency says.
    stiff = np.array([[1.0 + carried * pace, -carried * pace], [-pace, pace]])
    unit = 2.0 * np.pi * frequency / np.sqrt(np.linalg.eigvals(stiff).real.min())
    mass = spring / unit**2
    dashpot = 2.0 * damping * mass * unit
    between = 2.0 * damping * carried * mass * unit * np.sqrt(pace)
    assert at_start(made, REST, 2.0) == pytest.approx(2.0 * dashpot)
    place = REST + 5.0

    def move(t, s):
        pull = carried * pace * spring * (s[0] - s[2]) + between * (s[1] - s[3])
        push = spring * (place - s[0]) - dashpot * s[1]
        return [s[1], (push - pull) / mass, s[3], pull / (carried * mass)]

    s = integrated(move, [REST, 0.0, REST, 0.0], 6.0)
    expected = spring * (place - s[0]) - dashpot * s[1]
    felt = held(made, place, 6.0)[:-1]
    np.testing.assert_allclose(felt, expected, atol=0.01 * spring * 5.0)
