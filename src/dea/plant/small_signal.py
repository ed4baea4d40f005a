"""The exact first and second frequency responses of a film about the state that it is in.

The film is a system of differential equations in its branches, its charge and the ball's motion,
with the in-plane stretch given by (M3) at every instant. Its first response follows from the
linearised equations, its second from their second derivatives (Rugh, Nonlinear System Theory, 1981,
chapter 2: growing exponentials, of which the coefficients at f and at 2 f balance)::

    X₁ = (jω − A)⁻¹ B,  H₁ = C X₁ + D
    X₂ = (2jω − A)⁻¹ b₂,  H₂(f, f) = C X₂ + d₂,
    (b₂, d₂) = ½ ∂²(ẋ, y) along (X₁, 1) twice

Derivatives are central differences. The slow creep of the state itself is left out, as in any
response at one instant.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array, Complex
from dea.plant.film import FILM_VOLTAGE, GRAVITY, TIME, FilmState, V, X, Y, stretch
from dea.plant.membrane import ZONES, Film, Source, capacitance, relaxation, settle, zones

_FIRST, _SECOND = 1e-5, 1e-3  # relative steps of first and second differences


class Responses(NamedTuple):
    """H₁(f) in m/V and H₂(f, f) in m/V², from the amplifier's output, shape (frequencies,)."""

    first: Complex
    second: Complex


@njit(cache=True, error_model="numpy")
def hold(film: Film, state: FilmState, supply: float, duration: float) -> bool:
    """Carry a film over ``duration`` seconds at a constant supply (V), the ball at equilibrium.

    Steps of a fifth of the shortest branch time serve here, where a ball in motion needs shorter
    ones. Returns False, with the state undefined, where the film pulls in.
    """
    step = min(0.2 * film.branch_time.min(), 1.0) if film.branch_time.size else 1.0
    count = int(np.ceil(duration / step))
    table = zones(film)
    scalars = state.scalars
    for _ in range(count):
        stiffness = stretch(film, table, state, supply, duration / count)
        if not stiffness > 0.0:
            return False
        scalars[Y] = film.mass * GRAVITY / stiffness
        scalars[TIME] += duration / count
    scalars[V] = 0.0
    return True


@njit(cache=True, error_model="numpy")
def _rates(film: Film, table: Array, hours: float, x: float, z: Array) -> Array:
    """Return dz/dt for z of branches, charge, displacement, velocity and supply.

    The last element is the displacement.
    """
    stiffening = 1.0 + film.stiffness_ageing * hours
    count = film.branch_modulus.shape[0]
    size = count * ZONES * 2
    branches, slopes = z[:size].copy().reshape(count, ZONES, 2), np.empty((count, ZONES, 2))
    charge, y, v, supply = z[size], z[size + 1], z[size + 2], z[size + 3]
    # The second call starts at the solution, so that the stiffness is exact there.
    source = Source(0.0, charge, 0.0)
    x, _ = settle(film, table, branches, x, source, stiffening)
    x, stiffness = settle(film, table, branches, x, source, stiffening)
    relaxation(film, table, branches, x, slopes)
    rates = np.empty(z.size)
    rates[:size] = slopes.copy().reshape(size)
    inward = 1.0 / (film.electrode_resistance * (1.0 + film.electrode_ageing * hours))
    outward = (1.0 + film.leakage_ageing * hours) / film.leak_resistance
    voltage = charge / capacitance(film, x)
    rates[size] = (supply - voltage) * inward - voltage * outward
    rates[size + 1] = v
    rates[size + 2] = GRAVITY - (film.damping * v + stiffness * y) / film.mass
    rates[size + 3] = y
    return rates


def responses(film: Film, state: FilmState, supply: float, frequencies: Array) -> Responses:
    """Return the film's responses about ``state`` under a constant ``supply`` in V.

    At ``frequencies`` in Hz, shape (frequencies,).
    """
    scalars = state.scalars
    table, hours, x = zones(film), scalars[TIME] / 3600.0, scalars[X]
    charge = scalars[FILM_VOLTAGE] * capacitance(film, x)
    z = np.concatenate([state.branches.ravel(), [charge, scalars[Y], scalars[V], supply]])
    # Relative steps; the velocity's is one displacement per second.
    scale = np.abs(z)
    scale[-2] = scalars[Y]

    def rates(change: Array) -> Array:
        relative: Array = _rates(film, table, hours, x, z + scale * change) / scale_out
        return relative

    scale_out = np.append(scale[:-1], 1.0)
    n = z.size - 1
    units = _FIRST * np.eye(n + 1)
    slopes = np.array([(rates(unit) - rates(-unit)) / (2.0 * _FIRST) for unit in units]).T
    A, B, C, D = slopes[:n, :n], slopes[:n, n], slopes[n, :n], slopes[n, n]
    centre = rates(np.zeros(n + 1))

    def curvature(direction: Array) -> Array:
        size = float(np.abs(direction).max())
        if size == 0.0:
            return np.zeros(n + 1)
        step = _SECOND / size * direction
        return (rates(step) + rates(-step) - 2.0 * centre) * (size / _SECOND) ** 2

    first: Complex = np.empty(frequencies.size, dtype=np.complex128)
    second: Complex = np.empty(frequencies.size, dtype=np.complex128)
    for k, omega in enumerate(2.0 * np.pi * np.asarray(frequencies)):
        wave = np.linalg.solve(1j * omega * np.eye(n) - A, B)
        first[k] = C @ wave + D
        direction = np.append(wave, 1.0)
        real, imaginary = direction.real, direction.imag
        mixed = curvature(real + imaginary) - curvature(real - imaginary)
        both = 0.5 * (curvature(real) - curvature(imaginary) + 0.5j * mixed)
        second[k] = C @ np.linalg.solve(2j * omega * np.eye(n) - A, both[:n]) + both[n]
    return Responses(first / supply, second / supply**2)
