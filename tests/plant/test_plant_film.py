"""The stepping of the film against an independent integration, and its faults."""

import numpy as np
import pytest
from films import elastic, nominal
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dea.plant import film as dynamics
from dea.plant import membrane
from dea.plant.forces import stack
from dea.plant.membrane import EPSILON_0, ZONES


def run(film, supply, rest=600.0):
    state = dynamics.rest(film, rest)
    displacement, voltage = np.empty_like(supply), np.empty_like(supply)
    dynamics.advance(film, state, stack([]), supply, displacement, voltage)
    return displacement, voltage, state.scalars


def derivative(film, supply):
    """The same physics written from the free energy, in ξ and charge, x by root finding."""
    a, b, lp = film.electrode_radius, film.frame_radius, film.prestretch
    points, weights = np.polynomial.legendre.leggauss(ZONES - 1)
    radius = a * (b / a) ** (0.5 * (points + 1.0))
    widths = 0.5 * np.log(b / a) * weights
    volume = np.append(np.pi * a**2, 2 * np.pi * radius**2 * widths) * film.thickness / lp**2
    modulus, times = film.branch_modulus[:, None], film.branch_time[:, None]

    def stretches(x):
        share = (1 - x) / (b**2 / a**2 - 1)
        along = np.append(x, 1 + share * (1 + b**2 / radius**2))
        return lp * along, lp * np.append(x, 1 + share * (1 - b**2 / radius**2))

    def energy(x, xi, charge, stiffening):
        s, t = stretches(x)
        strain = s**2 + t**2 + (s * t) ** -2 - 3
        e, f = (s / xi[..., 0]) ** 2, (t / xi[..., 1]) ** 2
        density = film.yeoh_1 * strain + film.yeoh_2 * strain**2 + film.yeoh_3 * strain**3
        density = density + np.sum(0.5 * modulus * (e + f + 1 / (e * f) - 3), axis=0)
        return stiffening * volume @ density + 0.5 * charge**2 / load(x)

    def load(x):
        thickness = film.thickness / (lp * x) ** 2
        return EPSILON_0 * film.permittivity * np.pi * (a * x) ** 2 / thickness

    def stretch(xi, charge, stiffening):
        def slope(x):
            ends = (energy(x + d, xi, charge, stiffening) for d in (1e-5, -1e-5))
            return (next(ends) - next(ends)) / 2e-5

        return brentq(slope, 0.97, 1.6, xtol=1e-11)

    def tension(x, xi, charge, stiffening):
        """N along and its square of stretch, in every zone."""
        s, t = stretches(x)
        square, round_ = s**2, t**2
        strain = square + round_ + 1 / (square * round_) - 3
        slope = film.yeoh_1 + 2 * film.yeoh_2 * strain + 3 * film.yeoh_3 * strain**2
        e, f = square / xi[..., 0] ** 2, round_ / xi[..., 1] ** 2
        stress = 2 * slope * (square - 1 / (square * round_))
        stress = stiffening * (stress + np.sum(modulus * (e - 1 / (e * f)), axis=0))
        height = film.thickness / (s * t)
        tensions = stress * height
        tensions[0] -= EPSILON_0 * film.permittivity * (charge / load(x)) ** 2 / height[0]
        along = np.append(np.log(a * x / film.contact_radius), widths * s[1:] / t[1:])
        return 2 * np.pi / np.sum(along / tensions)

    def rates(t, state):
        y, v, charge = state[:3]
        xi = state[3:].reshape(-1, ZONES, 2)
        hours = t / 3600
        stiffening = 1 + film.stiffness_ageing * hours
        x = stretch(xi, charge, stiffening)
        s, r = stretches(x)
        e, f = s**2 / xi[..., 0] ** 2, r**2 / xi[..., 1] ** 2
        s_1, s_2 = e - 1 / (e * f), f - 1 / (e * f)
        creep = np.stack([s_1 - s_2 / 2, s_2 - s_1 / 2], axis=-1) * xi / (3 * times[..., None])
        voltage = charge / load(x)
        current = (supply(t) - voltage) / film.electrode_resistance
        current /= 1 + film.electrode_ageing * hours
        current -= voltage / film.leak_resistance * (1 + film.leakage_ageing * hours)
        pull = tension(x, xi, charge, stiffening) * y
        force = film.mass * 9.80665 - film.damping * v - pull
        return np.concatenate([[v, force / film.mass, current], creep.ravel()])

    return rates


@pytest.mark.parametrize(
    "changes",
    [
        {"electrode_resistance": 1e7, "leak_resistance": 5e7, "damping": 40.0},
        {
            "electrode_resistance": 2e6,
            "leak_resistance": 1e9,
            "stiffness_ageing": 5.0,
            "leakage_ageing": 50.0,
            "electrode_ageing": 20.0,
        },
    ],
)
def test_the_stepping_agrees_with_an_independent_integration(changes):
    film = nominal(**changes)
    film = film._replace(branch_modulus=film.branch_modulus[:2], branch_time=film.branch_time[:2])
    levels = np.array([0.0, 2800.0, 1200.0])
    piece = 0.1
    supply = np.repeat(levels, round(piece / dynamics.SUBSTEP))
    start = dynamics.rest(film, 60.0)
    stepped, voltage, _ = run(film, supply, rest=60.0)

    rates = derivative(film, lambda t: levels[min(int(t / piece), 2)])
    state = np.concatenate([[start.scalars[dynamics.Y], 0.0, 0.0], start.branches.ravel() ** -0.5])
    pieces = []
    for k in range(levels.size):
        span = (piece * k, piece * (k + 1) - 1e-12)
        times = np.clip(np.arange(supply.size // 3) * dynamics.SUBSTEP + span[0], *span)
        solved = solve_ivp(
            rates, span, state, "LSODA", np.append(times, span[1]), rtol=1e-6, atol=1e-10
        )
        pieces.append(solved.y[0, :-1])
        state = solved.y[:, -1]
    expected = np.concatenate(pieces)
    assert np.abs(stepped - expected).max() < 5e-3 * np.ptp(expected)
    assert np.sqrt(np.mean((stepped - expected) ** 2)) < 1e-3 * np.ptp(expected)
    assert voltage[supply.size // 3 - 1] == 0.0


def test_rest_agrees_with_a_stiff_solver():
    """Branches of a film held at its prestretch, by another method and in ξ."""
    film = nominal()
    state = dynamics.rest(film, 5000.0)
    lp = film.prestretch

    def rates(t, xi):
        e = (lp / xi) ** 2
        return xi * (e - e**-2) / (6 * film.branch_time)

    ones = np.ones(film.branch_time.size)
    xi = solve_ivp(rates, (0.0, 5000.0), ones, "LSODA", rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(state.branches[:, 2, 1] ** -0.5, xi, rtol=1e-6)
    assert np.ptp(state.branches, axis=(1, 2)).max() == 0.0
    e = (lp / xi) ** 2
    strain = 2 * lp**2 + lp**-4 - 3
    slope = film.yeoh_1 + 2 * film.yeoh_2 * strain + 3 * film.yeoh_3 * strain**2
    stress = 2 * slope * (lp**2 - lp**-4) + film.branch_modulus @ (e - e**-2)
    tension = stress * film.thickness / lp**2
    stiffness = 2 * np.pi * tension / np.log(film.frame_radius / film.contact_radius)
    assert state.scalars[dynamics.Y] == pytest.approx(film.mass * 9.80665 / stiffness, rel=1e-6)


def test_a_film_at_rest_stays_where_it_is():
    """But for the error of four Gauss points across the annulus."""
    displacement, _, _ = run(elastic(), np.zeros(20_000))
    np.testing.assert_allclose(displacement, displacement[0], rtol=1e-7)


def test_halving_the_voltage_quarters_a_small_response():
    film = elastic()
    small, half = (run(film, np.full(2000, level))[0] for level in (200.0, 100.0))
    ratio = (small[-1] - small[0]) / (half[-1] - half[0])
    assert ratio == pytest.approx(4.0, rel=0.02)


def test_an_oscillation_has_the_stiffness_and_the_damping_of_the_film():
    film = elastic(damping=0.05)
    state = dynamics.rest(film, 0.0)
    stiffness = film.mass * 9.80665 / state.scalars[dynamics.Y]
    assert stiffness == pytest.approx(dynamics.vertical_stiffness(film))
    state.scalars[dynamics.Y] *= 1.1
    displacement, voltage = np.empty((2, 400))
    dynamics.advance(film, state, stack([]), np.zeros(400), displacement, voltage)
    decay = film.damping / (2 * film.mass)
    omega = np.sqrt(stiffness / film.mass - decay**2)
    t = np.arange(400) * dynamics.SUBSTEP
    level = displacement[0] / 1.1
    wave = np.cos(omega * t) + decay / omega * np.sin(omega * t)
    expected = level + 0.1 * level * np.exp(-decay * t) * wave
    np.testing.assert_allclose(displacement, expected, atol=1e-5 * level)


def test_too_much_voltage_pulls_the_film_in_and_shorts_it_for_good():
    supply = np.concatenate([np.full(5000, 6000.0), np.full(5000, 3000.0)])
    displacement, voltage, scalars = run(nominal(), supply)
    assert scalars[dynamics.FAULT] == dynamics.PULLED_IN
    assert np.isfinite(displacement).all()
    assert voltage[-5000:].max() == 0.0
    assert displacement[-1] == pytest.approx(displacement[0], rel=0.2)


def test_a_thin_spot_breaks_down_before_it_is_pulled_in():
    film = nominal(breakdown_field=30e6)
    displacement, voltage, scalars = run(film, np.full(2000, 3000.0))
    assert scalars[dynamics.FAULT] == dynamics.BROKEN_DOWN
    assert np.isfinite(displacement).all()
    assert voltage[-1] == 0.0


def test_the_short_comes_with_the_step_beyond_the_threshold_and_no_other():
    film = nominal(pull_in_displacement=1.2e-3)
    displacement, voltage, scalars = run(film, np.full(5000, 3000.0))
    first = int(np.argmax(displacement > film.pull_in_displacement))
    assert scalars[dynamics.FAULT] == dynamics.PULLED_IN
    assert displacement[first] > film.pull_in_displacement
    # Before the first sub-step beyond it, the film carries its voltage; from then on, none.
    assert voltage[first - 1] > 1000.0
    assert (voltage[first:] == 0.0).all()


def test_no_film_carries_more_than_its_breakdown_field():
    film = elastic(breakdown_field=30e6)
    _, voltage, _ = run(film, np.linspace(0.0, 3000.0, 3000))
    state = dynamics.rest(film, 600.0)
    table, x, fields = membrane.zones(film), 1.0, []
    for level in voltage:
        x, _ = membrane.settle(film, table, state.branches, x, membrane.held(level), 1.0)
        fields.append(level / membrane.thickness(film, x))
    last = int(np.flatnonzero(np.array(fields) > 0.0)[-1])
    assert max(fields) <= 30e6
    assert fields[last] == pytest.approx(30e6, rel=2e-3)
    assert last < len(fields) - 100
    assert (voltage[last + 1 :] == 0.0).all()


def test_a_film_too_weak_for_its_mass_is_reported():
    assert np.isnan(dynamics.rest(nominal(mass=1.0), 600.0).scalars[dynamics.Y])
