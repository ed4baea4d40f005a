"""The film whose stretch is a state, against the film that is in balance at once."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from dea.configuration.bench import read_bench
from dea.plant.parameters import read_plain
from dea.plant.rig import Rig
from dea.simulation import Scales, SensorFilter, catalogue, load_simulation, prepared
from dea.simulation.devices.dea_membrane import GRAVITY, stiffness

DT = 0.02
BENCH = Path(__file__).parents[2] / "config" / "bench.yaml"
SCALES = Scales("V", "mm", 1.5, 3.2, 50.0, 0.6, 1.2, 0.0, 1.0, DT, 8.0)


def at_nominal(name, u):
    extended = prepared(load_simulation(name), u, DT, 1e-5)
    return extended.simulate(extended.layout.prior_means, u, DT)


def test_it_is_read_through_the_filter_of_the_bench():
    for actuator in read_bench(BENCH).actuators.values():
        assert load_simulation("dea_film").sensor_filter == SensorFilter(actuator.sensor.cutoff)


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
    y = extended.simulate(extended.layout.prior_means, u, DT)
    assert np.isfinite(y[:100]).all()
    assert np.isnan(y[-1])


@pytest.mark.parametrize("volts", [2.0, 3.6])
def test_the_mass_swings_at_the_frequency_of_its_displacement(volts):
    """Gravity and stiffness hold each other in balance: f = √(g / y) / 2π."""
    film = replace(load_simulation("dea_film"), sensor_filter=None)
    p = film.nominal
    p[film.parameter_names.index("dashpot")] = 0.0
    y = p[0] * GRAVITY / stiffness(volts, p)
    step = 1e-7
    balance = brentq(lambda s: slopes(film, [s, 100.0 * y, 0.0], volts, p)[0], 1.0, 1.3)
    x = np.array([balance, 100.0 * y, 0.0])
    J = np.column_stack([
        (slopes(film, x + push, volts, p) - slopes(film, x, volts, p)) / step
        for push in step * np.eye(3)[1:]
    ])[1:]  # fmt: skip
    swing = np.abs(np.linalg.eigvals(J).imag).max() / (2.0 * np.pi)
    assert swing == pytest.approx(np.sqrt(GRAVITY / y) / (2.0 * np.pi), rel=1e-3)


def slopes(film, x, volts, p):
    found = np.empty(3)
    film.compiled_derivative(np.array(x), volts, p, found)
    return found


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
    found, expected = np.empty(3), np.empty(3)
    for stretch in np.linspace(0.85, 1.7, 171):
        x = np.array([stretch, 0.07, 0.02])
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
    values = extended.layout.prior_means
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
        found = np.zeros(3)
        film.action.derivative(np.array([stretch, 0.07, 0.0]), stress, table, found)
        assert np.isnan(found).any()


@pytest.mark.parametrize(("cutoff", "within"), [(np.inf, 3e-3), (15.0, 6e-3)])
def test_it_moves_and_is_read_as_the_elastic_film_of_the_plant(cutoff, within):
    parameters = read_plain(BENCH)
    film = parameters.film._replace(damping=0.16)
    parameters = replace(
        parameters, film=film, sensor=parameters.sensor._replace(cutoff=cutoff, noise=0.0)
    )
    rng = np.random.default_rng(6)
    volts = np.repeat(rng.uniform(1.0, 3.2, 60), 7)
    counts = parameters.output_converter.to_counts(volts)
    expected = 1e3 * Rig(parameters, seed=1).respond(counts)
    u = parameters.output_converter.to_values(counts)
    simulation = replace(load_simulation("dea_film"), sensor_filter=None)
    if cutoff < np.inf:
        simulation = replace(simulation, sensor_filter=SensorFilter(cutoff))
    extended = prepared(simulation, u, DT, 1e-6)
    values = extended.layout.prior_means
    names = [p.name for p in extended.layout.parameters]
    for name, value in (*of_plant(film), ("viscosity", 10.0), ("dashpot", film.damping)):
        values[names.index(name)] = value
    # It starts at the first voltage, the plant without one.
    found, settled = extended.simulate(values, u, DT), slice(50, None)
    late = 0.5e-3 if cutoff < np.inf else 0.0  # of the plant's filter in steps, at most
    error = found - expected
    rate = np.gradient(expected, DT)
    error -= rate * np.clip(rate[settled] @ error[settled] / (rate @ rate), -late, late)
    assert np.std(error[settled]) < within * np.std(expected[settled])


def of_plant(film):
    """Return names and values of the parameters that the simulation shares with the plant."""
    return (
        ("mass", film.mass), ("shear_c10", film.yeoh_1), ("shear_c20", film.yeoh_2),
        ("shear_c30", film.yeoh_3), ("prestretch", film.prestretch),
        ("permittivity", film.permittivity),
    )  # fmt: skip


def with_a_start_of(name, u):
    """Return the film with an effect attached, and values at the effect's first start."""
    effect = catalogue()[name]
    extended = prepared(load_simulation("dea_film"), u, DT, 1e-5).attach(effect, SCALES)
    values = extended.layout.prior_means
    values[extended.layout.effect_slices[0]] = effect.starts(SCALES)[0]
    return extended, values, [p.name for p in extended.layout.parameters].index("viscosity")


def test_a_force_keeps_its_ratio_to_the_films_whatever_the_viscosity():
    u = np.concatenate([np.full(50, 2.0), np.full(100, 3.0)])
    extended, values, at = with_a_start_of("strain_stiffening", u)
    settled = []
    for viscosity in (300.0, 3000.0):
        values[at] = viscosity
        settled.append(extended.simulate(values, u, DT)[-1])
    assert settled[0] == pytest.approx(settled[1], rel=1e-6)


def test_a_fitted_force_does_not_depend_on_the_nominal_viscosity():
    u = np.concatenate([np.full(50, 2.0), np.full(100, 3.0)])
    extended, values, at = with_a_start_of("strain_stiffening", u)
    own = extended.simulation
    changed = replace(own.parameters[at], nominal=2.0 * own.parameters[at].nominal)
    parameters = (*own.parameters[:at], changed, *own.parameters[at + 1 :])
    later = replace(extended, simulation=replace(own, parameters=parameters))
    expected = extended.simulate(values, u, DT)
    np.testing.assert_array_equal(later.simulate(values, u, DT), expected)


@pytest.mark.parametrize("viscosity", [30.0, 1000.0])
def test_a_stiff_film_does_not_diverge_with_a_force(viscosity):
    u = np.repeat(np.random.default_rng(4).uniform(1.5, 3.2, 40), 10)
    extended, values, at = with_a_start_of("viscoelastic_creep", u)
    values[at] = viscosity
    for start in catalogue()["viscoelastic_creep"].starts(SCALES):
        values[extended.layout.effect_slices[0]] = (2.0, *start[1:])
        assert np.isfinite(extended.simulate(values, u, DT)).all()
