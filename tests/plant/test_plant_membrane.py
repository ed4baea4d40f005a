"""The film in its plane against energies, boundary-value problems and thermodynamics."""

import numpy as np
import pytest
from films import elastic, nominal
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dea.plant import membrane
from dea.plant.membrane import EPSILON_0, ZONES, Source, held

NONE = np.zeros((0, ZONES, 2))


def settled(film, voltage):
    table = membrane.zones(film)
    x = 1.0
    for part in np.linspace(0.0, 1.0, 30):
        x, stiffness = membrane.settle(film, table, NONE, x, held(part * voltage), 1.0)
    return x, stiffness


def nominal_stress(film, stretch, other):
    """Of a Yeoh film in plane stress, from the derivative of its energy."""
    strain = stretch**2 + other**2 + (stretch * other) ** -2 - 3
    slope = film.yeoh_1 + 2 * film.yeoh_2 * strain + 3 * film.yeoh_3 * strain**2
    return slope * (2 * stretch - 2 * stretch**-3 * other**-2)


def field_stress(film, stretch, other, voltage):
    """What the field takes from the nominal stress."""
    permittivity = EPSILON_0 * film.permittivity
    return permittivity * (voltage / film.thickness) ** 2 * stretch * other**2


def stretch_of(film, wanted, other, voltage):
    """Return the stretch at which the nominal stress less the field's is as wanted."""

    def excess(stretch):
        return (
            nominal_stress(film, stretch, other)
            - field_stress(film, stretch, other, voltage)
            - wanted
        )

    return brentq(excess, 0.3, 12.0, xtol=1e-8)


def shot(film, voltage, start, weight):
    """Integrate the axisymmetric membrane from the contact outwards; return radius and height.

    Exact equilibrium at large displacements: the reference radius ρ is that of the film before
    stretching, P = ρ S cos φ the horizontal and weight/(2πH₀) = ρ S sin φ the vertical force.
    """
    down = weight / (2 * np.pi * film.thickness)
    edges = np.array([film.contact_radius, film.electrode_radius, film.frame_radius])
    edges = edges / film.prestretch
    state = start
    for low, high, volts in ((edges[0], edges[1], voltage), (edges[1], edges[2], 0.0)):

        def rates(rho, state, volts=volts):
            radius, _, across = state
            other = radius / rho
            force = np.hypot(across, down)
            along = stretch_of(film, force / rho, other, volts)
            hoop = nominal_stress(film, other, along) - field_stress(film, other, along, volts)
            return [along * across / force, along * down / force, hoop]

        state = solve_ivp(rates, (low, high), state, rtol=1e-5, atol=1e-9).y[:, -1]
    return state


@pytest.mark.parametrize("voltage", [1940.0, 2800.0])
def test_the_disc_grows_as_in_the_exact_annulus(voltage):
    """Ritz's one degree of freedom against the boundary-value problem that it approximates."""
    film = elastic()
    x, _ = settled(film, voltage)

    def miss(x):
        stretch = film.prestretch * x
        inner = film.electrode_radius / film.prestretch
        net = nominal_stress(film, stretch, stretch)
        net -= field_stress(film, stretch, stretch, voltage)

        def rates(rho, state):
            along = stretch_of(film, state[1] / rho, state[0] / rho, 0.0)
            return [along, nominal_stress(film, state[0] / rho, along)]

        outer = film.frame_radius / film.prestretch
        start = [stretch * inner, inner * net]
        end = solve_ivp(rates, (inner, outer), start, rtol=1e-5, atol=1e-9).y[0, -1]
        return end - film.frame_radius

    exact = brentq(miss, 1.0, 1.0 + 1.2 * (x - 1.0), xtol=1e-5)
    assert x - 1.0 == pytest.approx(exact - 1.0, rel=0.03)


@pytest.mark.parametrize(("voltage", "within"), [(0.0, 0.05), (1940.0, 0.05), (2800.0, 0.09)])
def test_the_ball_hangs_as_in_the_exact_membrane(voltage, within):
    """Against large displacements of the whole membrane: the cone is steep at the contact alone."""
    film = elastic()
    x, stiffness = settled(film, voltage)
    weight = film.mass * 9.80665
    radius = film.contact_radius * x
    low = film.contact_radius / film.prestretch

    def end(across):
        return shot(film, voltage, [radius, 0.0, across], weight)

    stretch = film.prestretch * x
    net = nominal_stress(film, stretch, stretch) - field_stress(film, stretch, stretch, voltage)
    across = brentq(
        lambda across: end(across)[0] - film.frame_radius, 0.7 * low * net, 1.3 * low * net,
        xtol=1e-6 * low * net,
    )  # fmt: skip
    assert weight / stiffness == pytest.approx(end(across)[1], rel=within)


def test_the_force_is_the_gradient_of_the_energy():
    """At a held voltage, of elastic energy less co-energy; at a held charge, of the sum of both."""
    film = elastic()
    table = membrane.zones(film)

    def density(stretch, other):
        strain = stretch**2 + other**2 + (stretch * other) ** -2 - 3
        return film.yeoh_1 * strain + film.yeoh_2 * strain**2 + film.yeoh_3 * strain**3

    a, b = film.electrode_radius, film.frame_radius
    edges = np.geomspace(a, b, 2001)
    radius = np.sqrt(edges[1:] * edges[:-1])
    volume = np.pi * np.diff(edges**2) * film.thickness / film.prestretch**2

    def elastic_energy(x):
        share = -(x - 1) / (b**2 / a**2 - 1)
        along = film.prestretch * (1 + share * (1 + b**2 / radius**2))
        round_ = film.prestretch * (1 + share * (1 - b**2 / radius**2))
        disc = np.pi * a**2 * film.thickness / film.prestretch**2
        both = film.prestretch * x
        return disc * density(both, both) + volume @ density(along, round_)

    def load(x):
        area, thickness = np.pi * (a * x) ** 2, film.thickness / (film.prestretch * x) ** 2
        return EPSILON_0 * film.permittivity * area / thickness

    x, voltage, charge = 1.12, 2100.0, 1.4e-6
    step = 1e-4
    for source, energy in (
        (held(voltage), lambda x: elastic_energy(x) - 0.5 * load(x) * voltage**2),
        (Source(0.0, charge, 0.0), lambda x: elastic_energy(x) + 0.5 * charge**2 / load(x)),
    ):
        force, slope, _, _ = membrane.balance(film, table, NONE, x, source, 1.0)
        low, here, high = energy(x - step), energy(x), energy(x + step)
        assert force == pytest.approx(-(high - low) / (2 * step), rel=1e-4)
        assert slope == pytest.approx(-(high - 2 * here + low) / step**2, rel=1e-3)


def test_a_source_settles_at_the_rate_of_resistance_and_capacitance():
    film = nominal()
    table, ones = membrane.zones(film), np.ones((film.branch_modulus.size, ZONES, 2))
    load = membrane.capacitance(film, 1.1)
    source = Source(2000.0, 500.0 * load, 0.3 * load)
    expected = 2000.0 - 1500.0 * np.exp(-0.3)
    found, held_there = (
        membrane.balance(film, table, ones, 1.1, each, 1.0) for each in (source, held(expected))
    )
    assert found[0] == pytest.approx(held_there[0], rel=1e-12)
    assert found[3] == pytest.approx(held_there[3], rel=1e-12)
    step = 1e-6
    forces = [membrane.balance(film, table, ones, 1.1 + d, source, 1.0)[0] for d in (-step, step)]
    assert found[1] == pytest.approx((forces[1] - forces[0]) / (2 * step), rel=1e-5)


def test_what_a_branch_loses_it_dissipates():
    """At held stretches its stored energy falls by stress times flow, never rises."""
    film = nominal()
    table = membrane.zones(film)
    rng = np.random.default_rng(1)
    branches = 0.1 * np.exp(rng.normal(0.0, 0.4, (film.branch_modulus.size, ZONES, 2)))
    slopes = np.empty_like(branches)
    membrane.relaxation(film, table, branches, 1.2, slopes)
    along = film.prestretch * (1.0 + table[:, 0] * 0.2)
    across = film.prestretch * (1.0 + table[:, 1] * 0.2)
    square = np.stack([along**2, across**2], axis=1)

    def energy(q):
        e = square * q
        return 0.5 * film.branch_modulus[:, None] * (e.sum(2) + 1 / e.prod(2) - 3)

    step = 1e-6 * film.branch_time[:, None, None]
    fall = (energy(branches - step * slopes) - energy(branches + step * slopes)) / (
        2 * step[..., 0]
    )
    e = square * branches
    stress = film.branch_modulus[:, None, None] * (e - 1 / e.prod(2, keepdims=True))
    flow = -0.5 * slopes / branches  # ξ̇/ξ
    assert (fall > 0.0).all()
    np.testing.assert_allclose(fall, (stress * flow).sum(2), rtol=1e-6)
    # Of both directions alike, the flow is that of a dashpot of viscosity μ τ.
    np.testing.assert_allclose(
        flow[..., 0] * 3 * film.branch_time[:, None],
        (stress[..., 0] - 0.5 * stress[..., 1]) / film.branch_modulus[:, None],
        rtol=1e-12,
    )


def test_no_tension_is_no_solution():
    film = elastic()
    table = membrane.zones(film)
    assert np.isnan(membrane.settle(film, table, NONE, 1.0, held(6000.0), 1.0)[0])


def test_capacitance_is_that_of_a_plate():
    film = nominal()
    area = np.pi * (17.5e-3 * 1.1) ** 2
    thickness = 0.5e-3 / (film.prestretch * 1.1) ** 2
    expected = 8.8541878128e-12 * film.permittivity * area / thickness
    assert membrane.capacitance(film, 1.1) == pytest.approx(expected)
    assert membrane.thickness(film, 1.1) == pytest.approx(thickness)
