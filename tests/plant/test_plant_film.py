"""The stepping of the film against published-style figures and an independent integration."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dea.plant import film as dynamics
from dea.plant.forces import stack
from dea.plant.parameters import read_parameters

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
PERFECT_ELECTRODES = {"electrode_resistance": 1.0, "leak_resistance": 1e18}


def nominal(**changes):
    film = read_parameters(CONFIG, "dea1").film
    plain = {
        "contact_radius": 4.5e-3,
        "prestretch": 2.5,
        "stiffness_ageing": 0.0,
        "leakage_ageing": 0.0,
        "electrode_ageing": 0.0,
    }
    return film._replace(**{**plain, **changes})


def run(film, supply, rest=600.0):
    branches = np.ones((film.branch_modulus.size, 2))
    scalars = np.zeros(5)
    scalars[dynamics.Y] = dynamics.rest(film, branches, rest)
    state = dynamics.FilmState(scalars, branches)
    displacement, voltage = np.empty_like(supply), np.empty_like(supply)
    dynamics.advance(film, state, stack([]), supply, displacement, voltage)
    return displacement, voltage, scalars


def derivative(film, supply, hours):
    """The same physics written from the free energy, with the film's charge as a state."""
    width = film.frame_radius - film.contact_radius
    area = np.pi * (film.frame_radius**2 - film.contact_radius**2)
    volume = area * film.thickness / film.prestretch**2
    epsilon = 8.8541878128e-12 * film.permittivity

    def stress_1(stretch_1, stretch_2):
        return stretch_1**2 - (stretch_1 * stretch_2) ** -2

    def rates(t, state):
        y, v, charge = state[:3]
        stretch_1 = film.prestretch * np.sqrt(1 + y**2 / width**2)
        stretch_2 = film.prestretch
        height = film.thickness / stretch_1 / stretch_2
        voltage = charge / (epsilon * volume / height**2)
        strain = stretch_1**2 + stretch_2**2 + (stretch_1 * stretch_2) ** -2 - 3
        slope = film.yeoh_1 + 2 * film.yeoh_2 * strain + 3 * film.yeoh_3 * strain**2
        stress = 2 * slope * stress_1(stretch_1, stretch_2)
        creep = []
        inner = state[3:].reshape(-1, 2)
        branches = zip(film.branch_modulus, film.branch_time, inner, strict=True)
        for modulus, time, (xi_1, xi_2) in branches:
            s_1 = stress_1(stretch_1 / xi_1, stretch_2 / xi_2)
            s_2 = stress_1(stretch_2 / xi_2, stretch_1 / xi_1)
            stress += modulus * s_1
            creep += [xi_1 * (s_1 - s_2 / 2) / (3 * time), xi_2 * (s_2 - s_1 / 2) / (3 * time)]
        aged = hours + t / 3600
        stress = stress * (1 + film.stiffness_ageing * aged) - epsilon * (voltage / height) ** 2
        pull = volume * stress * y / (width**2 + y**2)
        current = (supply(t) - voltage) / film.electrode_resistance
        current /= 1 + film.electrode_ageing * aged
        current -= voltage / film.leak_resistance * (1 + film.leakage_ageing * aged)
        return [v, 9.80665 - (film.damping * v + pull) / film.mass, current, *creep]

    return rates


@pytest.mark.parametrize(
    ("prestretch", "after_1_s", "after_1800_s"), [(2.5, 0.42, 0.65), (3.0, 1.30, 2.53)]
)
def test_three_kilovolts_after_ten_minutes_of_rest(prestretch, after_1_s, after_1800_s):
    film = nominal(prestretch=prestretch, **PERFECT_ELECTRODES)
    displacement, _, scalars = run(film, np.full(1_800_001, 3000.0))
    response = 1e3 * (displacement - displacement[0])
    assert response[1000] == pytest.approx(after_1_s, abs=0.01)
    assert response[-1] == pytest.approx(after_1800_s, abs=0.03)
    assert scalars[dynamics.FAULT] == dynamics.WHOLE


def test_field_capacitance_and_resonance_are_those_of_such_films():
    film = nominal(**PERFECT_ELECTRODES)
    displacement, _, _ = run(film, np.zeros(1))
    branches = np.ones((3, 2))
    y = dynamics.rest(film, branches, 600.0)
    assert y == displacement[0]
    assert 3000.0 / dynamics.thickness(film, y) == pytest.approx(38e6, rel=0.02)
    assert dynamics.capacitance(film, y) == pytest.approx(0.62e-9, rel=0.01)
    force = [dynamics.tension(film, branches, y + step, 0.0, 1.0) for step in (-1e-6, 1e-6)]
    stiffness = (force[1] - force[0]) / 2e-6
    assert np.sqrt(stiffness / film.mass) / (2 * np.pi) == pytest.approx(21.0, rel=0.02)


@pytest.mark.parametrize(
    "changes",
    [
        {"electrode_resistance": 1e7, "leak_resistance": 5e7, "prestretch": 2.8},
        {"electrode_resistance": 1e7, "damping": 40.0},
        {
            "electrode_resistance": 1e6,
            "leak_resistance": 1e9,
            "stiffness_ageing": 5.0,
            "leakage_ageing": 50.0,
            "electrode_ageing": 20.0,
        },
    ],
)
def test_the_stepping_agrees_with_an_independent_integration(changes):
    film = nominal(**changes)
    levels = np.array([0.0, 3000.0, 1200.0, 2600.0])
    supply = np.repeat(levels, 500)
    start = run(film, np.zeros(1), rest=60.0)[0][0]
    branches = np.ones((3, 2))
    dynamics.rest(film, branches, 60.0)
    stepped, voltage, _ = run(film, supply, rest=60.0)

    rates = derivative(film, lambda t: levels[min(int(t / 0.5), 3)], hours=0.0)
    state = np.array([start, 0.0, 0.0, *(branches**-0.5).ravel()])
    pieces = []
    for k in range(4):
        span = (0.5 * k, 0.5 * (k + 1) - 1e-12)
        times = np.linspace(0.5 * k, 0.5 * (k + 1), 501)[:-1]
        solved = solve_ivp(
            rates, span, state, "LSODA", np.clip(times, *span), rtol=1e-10, atol=1e-14
        )
        pieces.append(solved.y[0])
        state = solve_ivp(rates, span, state, "LSODA", rtol=1e-10, atol=1e-14).y[:, -1]
    expected = np.concatenate(pieces)
    assert np.abs(stepped - expected).max() < 5e-3 * np.ptp(expected)
    assert np.sqrt(np.mean((stepped - expected) ** 2)) < 5e-4 * np.ptp(expected)
    assert voltage[499] == 0.0


def test_rest_agrees_with_a_stiff_solver():
    film = nominal()
    branches = np.ones((3, 2))
    y = dynamics.rest(film, branches, 5000.0)
    rates = derivative(film, lambda t: 0.0, hours=0.0)
    start = [dynamics.equilibrium(film, np.ones((3, 2))), 0.0, 0.0, *np.ones(6)]
    unaged = solve_ivp(rates, (0.0, 5000.0), start, "LSODA", rtol=1e-9, atol=1e-13).y[:, -1]
    assert y == pytest.approx(unaged[0], rel=1e-4)
    np.testing.assert_allclose(branches**-0.5, unaged[3:].reshape(3, 2), rtol=1e-4)


def test_a_film_at_rest_stays_where_it_is():
    film = nominal()._replace(branch_modulus=np.zeros(0), branch_time=np.zeros(0))
    displacement, _, _ = run(film, np.zeros(20_000))
    np.testing.assert_allclose(displacement, displacement[0], rtol=1e-9)


def test_halving_the_voltage_quarters_a_small_response():
    film = nominal(**PERFECT_ELECTRODES)
    film = film._replace(branch_modulus=np.zeros(0), branch_time=np.zeros(0))
    small, half = (run(film, np.full(2000, level))[0] for level in (200.0, 100.0))
    ratio = (small[-1] - small[0]) / (half[-1] - half[0])
    assert ratio == pytest.approx(4.0, rel=0.01)


def test_too_much_voltage_pulls_the_film_in_and_shorts_it_for_good():
    film = nominal(prestretch=3.2)
    supply = np.concatenate([np.full(5000, 6000.0), np.full(5000, 3000.0)])
    displacement, voltage, scalars = run(film, supply)
    assert scalars[dynamics.FAULT] == dynamics.PULLED_IN
    assert np.isfinite(displacement).all()
    assert voltage[-5000:].max() == 0.0


def test_a_thin_spot_breaks_down_before_it_is_pulled_in():
    film = nominal(breakdown_field=30e6)
    displacement, voltage, scalars = run(film, np.full(2000, 3000.0))
    assert scalars[dynamics.FAULT] == dynamics.BROKEN_DOWN
    assert np.isfinite(displacement).all()
    assert voltage[-1] == 0.0


def test_the_short_comes_with_the_step_beyond_the_threshold_and_no_other():
    film = nominal(prestretch=3.2)
    displacement, voltage, _ = run(film, np.full(5000, 6000.0))
    far = np.abs(displacement) > film.pull_in_displacement
    first = int(np.argmax(far))
    assert far[first]
    # Before the first sub-step beyond it, the film carries its voltage; from then on, none.
    assert voltage[first - 1] > 1000.0
    assert (voltage[first:] == 0.0).all()


def test_no_film_carries_more_than_its_breakdown_field():
    film = nominal(breakdown_field=30e6, **PERFECT_ELECTRODES)
    ramp = np.linspace(0.0, 3000.0, 3000)
    displacement, voltage, _ = run(film, ramp)
    field = voltage / np.array([dynamics.thickness(film, y) for y in displacement])
    last = int(np.flatnonzero(field > 0.0)[-1])
    assert field.max() <= 30e6
    assert field[last] == pytest.approx(30e6, rel=2e-3)
    assert last < field.size - 100
    assert (voltage[last + 1 :] == 0.0).all()


def test_a_film_too_weak_for_its_mass_is_reported():
    film = nominal(mass=1.0)
    assert np.isnan(dynamics.rest(film, np.ones((3, 2)), 600.0))
