"""Hidden creep, relaxation and hysteresis against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import built, held, resist, sweep
from made_draws import SHARES, UNEVEN, drawn, form
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from dea.plant.film import SUBSTEP

K, TRAVEL, TIME, REST = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.time, UNEVEN.rest
LAST = UNEVEN.duration
T = np.arange(1, 3001) * SUBSTEP
PATH = REST + 3.0 + 4.0 * np.sin(2.0 * np.pi * 1.3 * T) + np.where(T > 1.7, 2.0, 0.0)
# Of a spectrum, in band periods: three a decade from 0.03 on.
DECADES = 0.03 * 10.0 ** (np.arange(18) / 3.0)
EACH = pytest.mark.parametrize("share", SHARES)


def relaxed(response, time):
    """Return what a response, held over each sub-step, has left after a Maxwell element's time."""
    kept = np.exp(-SUBSTEP / time)
    return response - lfilter([1.0 - kept], [1.0, -kept], response)


def power_spectrum(d):
    return DECADES ** -d.at(0.1, 0.35), DECADES


def one_element(d):
    return np.ones(1), np.array([d.log(1.5, 20.0)])


def fractional_spectrum(d):
    order, middle = d.at(0.5, 0.75), d.log(0.5, 5.0)
    power = (DECADES / middle) ** order
    return power / (1.0 + 2.0 * np.cos(order * np.pi) * power + power**2), DECADES


def box(d):
    first = d.integers(2, 5)
    inside = slice(first, first + d.integers(7, 10))
    return np.ones(18)[inside], DECADES[inside]


SPECTRA = {
    "spring_pot": power_spectrum,
    "standard_linear_solid": one_element,
    "fractional_zener": fractional_spectrum,
    "logarithmic_creep": box,
}


@pytest.mark.parametrize("name", SPECTRA)
@EACH
def test_a_spectrum_is_a_sum_of_maxwell_elements(name, share):
    made, draws = form(name, 0.3, share)
    weights, times = SPECTRA[name](draws)
    # One band period after a step the force is that of 0.3 stiffnesses.
    weights = weights * 0.3 * K / (weights @ np.exp(-1.0 / times))
    parts = [w * relaxed(PATH - REST, time * TIME) for w, time in zip(weights, times, strict=True)]
    np.testing.assert_allclose(resist(made, PATH), sum(parts), atol=1e-9)


@EACH
def test_the_fitted_spectrum_is_a_stretched_exponential(share):
    made, draws = form("stretched_exponential", 0.3, share)
    order, middle = draws.at(0.4, 0.7), draws.log(3.0, 30.0)
    felt = held(made, REST + 2.0, 20.0 * TIME)
    periods = np.arange(1, felt.size + 1) * SUBSTEP / TIME
    expected = 0.6 * K * np.exp((1.0 / middle) ** order - (periods / middle) ** order)
    late = periods > 0.1
    np.testing.assert_allclose(felt[late], expected[late], rtol=6e-3)


@EACH
@pytest.mark.parametrize("stretch", [-3.0, 5.0])
def test_a_dashpot_of_norton_relaxes_as_a_power_of_time(share, stretch):
    made, draws = form("norton_dashpot", 0.3, share)
    length, time = draws.at(0.1, 0.4) * TRAVEL, TIME * draws.log(1.0, 8.0)
    order = draws.at(2.0, 5.0) - 1.0
    left = ((abs(stretch) / length) ** -order + order * T / time) ** (-1.0 / order)
    expected = 0.9 * K * np.sign(stretch) * length * left
    np.testing.assert_allclose(held(made, REST + stretch, 3.0), expected, rtol=1e-9)


@EACH
@pytest.mark.parametrize("stretch", [-3.0, 5.0])
def test_an_activated_dashpot_relaxes_as_the_tanh_of_half_its_stretch(share, stretch):
    made, draws = form("activated_dashpot", 0.3, share)
    length, time = draws.at(0.08, 0.25) * TRAVEL, TIME * draws.log(2.0, 10.0)
    half = np.tanh(0.5 * stretch / length) * np.exp(-T / time)
    expected = 1.2 * K * length * np.log((1.0 + half) / (1.0 - half))
    np.testing.assert_allclose(held(made, REST + stretch, 3.0), expected, rtol=1e-6)


@EACH
def test_a_quasi_linear_tissue_relaxes_its_response(share):
    made, draws = form("quasi_linear", 0.3, share)
    times = TIME * np.array([draws.at(0.4, 2.0), draws.at(8.0, 40.0)])
    length, first = draws.at(0.5, 1.2) * TRAVEL, draws.at(0.3, 0.7)
    parts = np.array([first, 1.0 - first])

    def response(y):
        return np.exp((y - REST) / length) - 1.0

    # At the top, one band period after a step, the force is that of 0.3 stiffnesses.
    top = 0.3 * K * (UNEVEN.top - REST) / response(UNEVEN.top) / (parts @ np.exp(-TIME / times))
    expected = sum(top * p * relaxed(response(PATH), t) for p, t in zip(parts, times, strict=True))
    np.testing.assert_allclose(resist(made, PATH), expected, atol=1e-9)


def power(t, d):
    first = d.at(0.02, 0.1) * LAST
    return 1.0 - (first / (first + t)) ** d.at(0.1, 0.5)


def two_exponentials(t, d):
    short, long = d.at(0.03, 0.1) * LAST, d.at(0.3, 0.8) * LAST
    return 2.0 - np.exp(-t / short) - np.exp(-t / long)


def logarithm(t, d):
    first = d.at(0.003, 0.03) * LAST
    return np.log((first + t) / first)


def hyperbola(t, d):
    return t / (d.at(0.08, 0.5) * LAST + t)


def drained(t, d):
    x = t / (d.at(0.1, 0.5) * LAST)
    return 1.0 - 0.491 * np.exp(-0.908 * x**0.5) - 0.509 * np.exp(-1.679 * x)


RELAXATIONS = {
    "power_relaxation": power,
    "two_times": two_exponentials,
    "maxwell_relaxation": lambda t, d: 1.0 - np.exp(-t / (d.at(0.1, 0.6) * LAST)),
    "draining_gel": drained,
    "logarithmic_relaxation": logarithm,
    "hyperbolic_relaxation": hyperbola,
}


@pytest.mark.parametrize("name", RELAXATIONS)
@EACH
def test_the_prestress_relaxes_as_its_course(name, share):
    made, draws = form(name, 0.2, share)
    lost = RELAXATIONS[name](T, draws) / RELAXATIONS[name](LAST, draws)
    np.testing.assert_allclose(resist(made, PATH), -0.2 * K * PATH * lost, atol=1e-9)


def by_masing(branch, path, turns):
    """Return the force along a path of monotonic pieces that end at these places, by his rule."""
    first = 0.5 * branch(2.0 * REST - path[: turns[0] + 1], path[: turns[0] + 1])
    felt, start = [first], turns[0]
    for end in turns[1:]:
        piece = path[start + 1 : end + 1]
        felt.append(felt[-1][-1] + branch(path[start], piece))
        start = end
    return np.concatenate(felt)


def hyperbolic_branch(d):
    length, reach = d.at(0.1, 0.4) * TRAVEL, d.at(0.8, 2.0) * TRAVEL

    def branch(start, end):
        way, middle = end - start, 0.5 * (start + end) - UNEVEN.median
        return 0.5 * K * way / (1.0 + abs(way) / length) * (1.0 + middle**2 / reach**2)

    return branch


def bent_branch(d):
    length, order, left = d.at(0.15, 0.5) * TRAVEL, d.at(2.0, 5.0), d.at(0.02, 0.2)

    def branch(start, end):
        way = end - start
        bent = (1.0 + abs(way / length) ** order) ** (-1.0 / order)
        return 0.5 * K * way * (left + (1.0 - left) * bent)

    return branch


def relays(d):
    width, middle = d.at(0.3, 0.8) * TRAVEL, UNEVEN.bottom + d.at(0.3, 0.7) * TRAVEL

    def branch(start, end):
        turned = np.arctan((end - middle) / width) - np.arctan((start - middle) / width)
        # Relays that switch let go of the mass.
        return -np.sign(turned) * 0.5 * turned**2 * 0.5 * K * TRAVEL

    return branch


@pytest.mark.parametrize(
    ("name", "branches"),
    [
        ("masing_loops", hyperbolic_branch),
        ("menegotto_pinto", bent_branch),
        ("preisach_product", relays),
    ],
)
@EACH
def test_each_branch_starts_anew_at_its_reversal(name, branches, share):
    made, draws = form(name, 0.5, share)
    path = sweep(9.0, 1.0, 7.0, 3.0, start=REST)
    expected = by_masing(branches(draws), path, [400, 800, 1200, 1600])
    np.testing.assert_allclose(resist(made, path), expected, atol=1e-9)
    down = sweep(-5.0, 2.0, start=REST)
    expected = by_masing(branches(draws), down, [400, 800])
    np.testing.assert_allclose(resist(drawn(name, 0.5, share)[0], down), expected, atol=1e-9)


def solved_along(slope, path):
    """Return what a law of the place and its direction gives along a path, from 0."""
    values, value = [], 0.0
    ends = np.flatnonzero(np.diff(np.sign(np.diff(path)))) + 1
    for piece in np.split(np.arange(path.size - 1), ends):
        y, side = path[piece[0]], np.sign(path[piece[0] + 1] - path[piece[0]])
        ways = np.abs(path[piece + 1] - y)
        solved = solve_ivp(
            lambda way, f, y=y, side=side: side * slope(f, y + side * way, side),
            (0.0, ways[-1]), [value], t_eval=ways, rtol=1e-9, atol=1e-9,
        )  # fmt: skip
        values.append(solved.y[0])
        value = values[-1][-1]
    return np.concatenate([[0.0], *values])


@EACH
def test_wen_s_deflection_is_the_solution_of_his_equation(share):
    made, draws = form("bouc_wen", 0.5, share)
    limit, order, loop = draws.at(0.08, 0.35) * TRAVEL, draws.at(1.2, 3.0), draws.at(0.55, 0.95)

    def slope(z, y, side):
        return 1.0 - np.abs(z / limit) ** order * (loop * np.sign(z * side) + 1.0 - loop)

    path = sweep(9.0, 1.0, 6.0, 4.5, start=REST, points=2000)
    expected = 0.5 * K * solved_along(slope, path)
    np.testing.assert_allclose(resist(made, path), expected, atol=2e-3 * 0.5 * K * limit)


@EACH
def test_coleman_and_hodgdon_s_force_is_the_solution_of_their_equation(share):
    made, draws = form("coleman_hodgdon", 0.5, share)
    rate, part = 1.0 / (draws.at(0.15, 0.5) * TRAVEL), draws.at(0.0, 0.5)

    def slope(f, y, side):
        return side * rate * (part * 0.5 * K * (y - REST) - f) + 0.5 * K

    path = sweep(9.0, 1.0, 6.0, 4.5, start=REST, points=4000)
    np.testing.assert_allclose(resist(made, path), solved_along(slope, path), atol=6e-4 * K)


@pytest.mark.parametrize("name", ["prandtl_sliders", "maxwell_slip"])
@pytest.mark.parametrize("seed", range(2))
def test_each_spring_has_its_own_slider(name, seed):
    effect = "coulomb_friction" if name == "maxwell_slip" else "rate_independent_hysteresis"
    made, defining = built(effect, name, 0.3, seed, UNEVEN)
    assert not defining
    rng = np.random.default_rng(seed)
    if name == "maxwell_slip":
        forces, stretches = rng.uniform(0.4, 1.0, 4), TRAVEL * 0.003 * 10.0 ** (np.arange(4) / 3.0)
        springs = 0.3 * K * TRAVEL * forces / forces.sum() / stretches
    else:
        springs = rng.uniform(0.3, 1.0, 6)
        springs *= 0.3 * K / springs.sum()
        stretches = TRAVEL * np.linspace(0.1, rng.uniform(0.3, 0.5), 6)

    def branch(start, end):
        slid = np.minimum(np.abs(end - start)[:, None], 2.0 * stretches)
        return np.sign(end - start) * (slid @ springs)

    path = sweep(9.0, 1.0, 6.0, start=REST)
    expected = by_masing(branch, path, [400, 800, 1200])
    np.testing.assert_allclose(resist(made, path), expected, atol=1e-9)
