"""The film whose stretch is a state, against the film that is in balance at once."""

from dataclasses import replace

import numpy as np
import pytest

from dea.simulation import load_simulation, prepared
from dea.simulation.devices.dea_membrane import GRAVITY, stiffness

DT = 0.02


def at_nominal(name, u):
    extended = prepared(load_simulation(name), u, DT, 1e-5)
    return extended.simulate(extended.values(np.zeros(extended.free.size)), u, DT)


@pytest.mark.parametrize("volts", [0.0, 1.5, 3.0, 3.6])
def test_it_settles_where_the_film_is_in_balance(volts):
    p = load_simulation("dea_membrane").nominal
    settled = at_nominal("dea_film", np.full(200, volts))[-1]
    assert settled == pytest.approx(1e3 * p[0] * GRAVITY / stiffness(volts, p), rel=1e-5)


def test_slowly_it_moves_as_the_film_that_is_in_balance():
    t = DT * np.arange(1000)
    u = 2.4 + 0.9 * np.sin(0.5 * t)
    found, expected = at_nominal("dea_film", u), at_nominal("dea_membrane", u)
    assert np.abs(found - expected).max() < 0.02 * np.ptp(expected)


def test_it_runs_away_beyond_pull_in():
    u = np.concatenate([np.full(100, 2.0), np.full(500, 8.0)])
    film = load_simulation("dea_film")
    extended = prepared(film, u[:100], DT, 1e-5)
    y = extended.simulate(extended.values(np.zeros(extended.free.size)), u, DT)
    assert np.isfinite(y[:100]).all()
    assert np.isnan(y[-1])


@pytest.mark.parametrize("scale", [0.9, 1.0])
@pytest.mark.parametrize("changed", [{}, {"prestretch": 2.6}, {"shear_c20": 200.0}])
@pytest.mark.parametrize("volts", [0.0, -2.0, 3.4])
def test_the_table_gives_the_rates_of_the_equations(volts, changed, scale):
    film = load_simulation("dea_film")
    names = film.parameter_names
    p = film.nominal
    for name, value in changed.items():
        p[names.index(name)] = value
    own = p.copy()
    own[names.index("permittivity")] *= scale
    [stress] = film.action.law(np.array([volts]), np.array([scale]), p)
    table = film.action.table(p)
    found, expected = np.empty(2), np.empty(2)
    for stretch in np.linspace(0.85, 1.7, 171):
        x = np.array([stretch, 7e-4])
        film.action.derivative(x, stress, table, found)
        film.derivative(x, volts, own, expected)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("interpolation", ["zero", "smooth"])
def test_it_moves_the_same_with_its_table_and_without(interpolation):
    t = DT * np.arange(1500)
    u = 2.4 + 0.8 * np.sin(2.0 * t) + 0.5 * np.sin(0.7 * t)
    film = replace(load_simulation("dea_film"), input_interpolation=interpolation)
    extended = prepared(film, u, DT, 1e-5)
    plain = replace(extended, simulation=replace(film, action=None))
    values = extended.values(np.zeros(extended.free.size))
    found, expected = (each.simulate(values, u, DT) for each in (extended, plain))
    # Between samples the voltage is interpolated without the table, its square with it.
    within = 1e-7 if interpolation == "zero" else 1e-3
    assert np.abs(found - expected).max() < within * np.ptp(expected)


def test_the_rates_are_those_of_the_table_wherever_the_film_may_be():
    film = load_simulation("dea_film")
    p = film.nominal
    [stress] = film.action.law(np.array([2.0]), np.ones(1), p)
    table = film.action.table(p)
    table[p.size + 2 :] = np.nan
    for stretch in np.linspace(0.96, 1.2, 13):
        found = np.zeros(2)
        film.action.derivative(np.array([stretch, 7e-4]), stress, table, found)
        assert np.isnan(found).any()
