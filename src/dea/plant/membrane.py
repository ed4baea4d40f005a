"""The film in its own plane: an electroded disc within a passive annulus.

The prestretched film has radius b at the clamped frame and is electroded out to radius a. Charged,
the disc grows by the in-plane stretch x and the annulus gives way (Ritz's approximation, with the
displacement of a linear elastic annulus)::

    R ≤ a:  λᵣ = λθ = λp x
    R > a:  λᵣ = λp (1 + α (1 + b²/R²)),  λθ = λp (1 + α (1 − b²/R²)),
            α = −(x − 1)/(b²/a² − 1)                                                    (M1)

Nominal stresses of an incompressible film in plane stress, with J = λᵣ² λθ²::

    Sᵣ = 2 W′(I₁)(λᵣ − 1/(J λᵣ)) + Σᵢ μᵢ (eᵣ − 1/(eᵣ eθ))/λᵣ,  e = λ² q,  q = 1/ξ²     (M2)

and for Sθ with the directions swapped. W is Yeoh's strain energy (Yeoh, Rubber Chem. Technol. 66,
1993), the branches are Maxwell elements with strain-like internal variables ξ (Reese and
Govindjee, Int. J. Solids Struct. 35, 1998). In the plane the film has no inertia: the virtual work
of the field (Suo, Acta Mech. Solida Sin. 23, 2010) and of the stresses balance::

    2 π ε a² λp² x³ V²/H₀ = ∫ (Sᵣ ∂λᵣ/∂x + Sθ ∂λθ/∂x) dΩ                                (M3)

Each of five zones is the disc or one Gauss-Legendre point in ln R across the annulus; quantities
per zone are in this order. Everything is in SI units.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array

EPSILON_0 = 8.8541878128e-12  # F/m
ZONES = 5
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(ZONES - 1)
_CLOSE = 1e-6  # change of x in a Newton step below which the next would change it by rounding alone
_TRIES = 50
_LARGEST_STEP = 0.03  # in x


class Film(NamedTuple):
    """The parameters of one film, its mass and its electrodes (SI units)."""

    frame_radius: float
    electrode_radius: float
    contact_radius: float
    thickness: float
    prestretch: float
    mass: float
    damping: float
    yeoh_1: float
    yeoh_2: float
    yeoh_3: float
    branch_modulus: Array
    branch_time: Array
    permittivity: float
    electrode_resistance: float
    leak_resistance: float
    stiffness_ageing: float
    leakage_ageing: float
    electrode_ageing: float
    pull_in_displacement: float
    breakdown_field: float


class Source(NamedTuple):
    """What charges the disc: V(x) = V∞ + (Q/C(x) − V∞) exp(−g/C(x)).

    That is the film voltage after a while at constant C: V∞ (V) is where it would settle, Q (C)
    the charge at first, g (F) the time passed times the conductance to and from the electrodes.
    """

    settled: float
    charge: float
    passed: float


@njit(cache=True, error_model="numpy")
def held(voltage: float) -> Source:
    """Return the source that holds ``voltage`` whatever the capacitance."""
    return Source(voltage, 0.0, 1.0)  # of 1 F: a film of 1 nF hardly changes it


@njit(cache=True, error_model="numpy")
def zones(film: Film) -> Array:
    """Return what a zone adds to virtual work and compliance, shape (ZONES, 4).

    The columns are ∂λᵣ/∂x and ∂λθ/∂x over λp (M1), the zone's volume (m³), and the length ratio
    dR/R that it spans; the disc's, which grows with x, is left at zero.
    """
    a, b = film.electrode_radius, film.frame_radius
    share = 1.0 / (b * b / (a * a) - 1.0)
    area = film.thickness / (film.prestretch * film.prestretch)
    half = 0.5 * np.log(b / a)
    table = np.empty((ZONES, 4))
    table[0, 0], table[0, 1], table[0, 2], table[0, 3] = 1.0, 1.0, np.pi * a * a * area, 0.0
    for k in range(1, ZONES):
        radius = a * np.exp(half * (1.0 + _POINTS[k - 1]))
        squared = (b / radius) ** 2
        table[k, 0] = -share * (1.0 + squared)
        table[k, 1] = -share * (1.0 - squared)
        table[k, 3] = half * _WEIGHTS[k - 1]
        table[k, 2] = 2.0 * np.pi * radius * radius * table[k, 3] * area
    return table


@njit(cache=True, error_model="numpy")
def capacitance(film: Film, x: float) -> float:
    """Return the capacitance of the disc in F: its area grows and its thickness falls with x²."""
    area = np.pi * film.electrode_radius**2 * film.prestretch**2
    return EPSILON_0 * film.permittivity * area * x**4 / film.thickness


@njit(cache=True, error_model="numpy")
def thickness(film: Film, x: float) -> float:
    """Return the thickness of the disc in m."""
    return film.thickness / (film.prestretch * x) ** 2


@njit(cache=True, error_model="numpy")
def balance(
    film: Film, table: Array, branches: Array, x: float, source: Source, stiffening: float
) -> tuple[float, float, float, float]:
    """Return the in-plane force, its slope in x, the compliance, and the disc's tension.

    ``branches``, shape (branches, ZONES, 2), holds q of every Maxwell branch; ``stiffening``
    scales all moduli. The force (N m, per unit of x) is the difference of the two sides of (M3);
    the compliance is ∫ dr/(r N), in m/N, from the contact to the frame; the tension is in N/m.
    """
    load = capacitance(film, x)
    left = np.exp(-source.passed / load)
    remaining = source.charge / load * left
    voltage = source.settled * (1.0 - left) + remaining
    # dV/dx, by way of the capacitance, which grows with the fourth power.
    late = (source.charge / load - source.settled) * left * source.passed / load
    voltage_slope = 4.0 * (late - remaining) / x
    prestretch, thickness = film.prestretch, film.thickness
    permittivity = EPSILON_0 * film.permittivity
    a = film.electrode_radius
    force, slope, compliance, disc_tension = 0.0, 0.0, 0.0, 0.0
    for k in range(ZONES):
        slope_1, slope_2 = prestretch * table[k, 0], prestretch * table[k, 1]
        stretch_1, stretch_2 = prestretch + slope_1 * (x - 1.0), prestretch + slope_2 * (x - 1.0)
        square_1, square_2 = stretch_1 * stretch_1, stretch_2 * stretch_2
        contraction = 1.0 / (square_1 * square_2)
        strain = square_1 + square_2 + contraction - 3.0
        energy_1 = film.yeoh_1 + strain * (2.0 * film.yeoh_2 + 3.0 * strain * film.yeoh_3)
        energy_2 = 2.0 * film.yeoh_2 + 6.0 * strain * film.yeoh_3
        along_1 = stretch_1 - contraction / stretch_1
        along_2 = stretch_2 - contraction / stretch_2
        stress_1, stress_2 = 2.0 * energy_1 * along_1, 2.0 * energy_1 * along_2
        straight_1 = 2.0 * energy_1 + 4.0 * energy_2 * along_1 * along_1
        straight_2 = 2.0 * energy_1 + 4.0 * energy_2 * along_2 * along_2
        pressed = 2.0 * energy_1 * contraction
        across = 4.0 * energy_2 * along_1 * along_2
        for i in range(branches.shape[0]):
            q_1, q_2 = branches[i, k, 0], branches[i, k, 1]
            modulus = film.branch_modulus[i]
            pressure = modulus * contraction / (q_1 * q_2)
            stress_1 += modulus * stretch_1 * q_1 - pressure / stretch_1
            stress_2 += modulus * stretch_2 * q_2 - pressure / stretch_2
            straight_1 += modulus * q_1
            straight_2 += modulus * q_2
            pressed += pressure
        straight_1 += 3.0 * pressed / square_1
        straight_2 += 3.0 * pressed / square_2
        across += 2.0 * pressed / (stretch_1 * stretch_2)
        volume = table[k, 2] * stiffening
        force -= volume * (stress_1 * slope_1 + stress_2 * slope_2)
        slope -= volume * (
            straight_1 * slope_1 * slope_1
            + straight_2 * slope_2 * slope_2
            + 2.0 * across * slope_1 * slope_2
        )
        tension = thickness * stiffening * stress_1 / stretch_2
        if k == 0:
            field = permittivity * voltage * voltage * prestretch * prestretch / thickness
            disc_tension = tension - field * x * x
            compliance = np.log(a * x / film.contact_radius) / disc_tension
            force += 2.0 * np.pi * a * a * field * x * x * x
            slope += 6.0 * np.pi * a * a * field * x * x
            field_slope = 2.0 * permittivity * voltage * voltage_slope
            field_slope *= prestretch * prestretch / thickness
            slope += 2.0 * np.pi * a * a * field_slope * x * x * x
        else:
            compliance += table[k, 3] * stretch_1 / (stretch_2 * tension)
    return force, slope, compliance, disc_tension


@njit(cache=True, error_model="numpy")
def settle(
    film: Film, table: Array, branches: Array, x: float, source: Source, stiffening: float
) -> tuple[float, float]:
    """Return the stretch x that (M3) holds near a first guess, and the vertical stiffness (N/m).

    Under a point force at its centre the film is a cone whose slope is F/(2πrN), so that the
    stiffness is 2π/∫ dr/(r N) (M4). Both are NaN where no stable x is found nearby, or the disc
    has lost its tension.
    """
    for _ in range(_TRIES):
        force, slope, compliance, tension = balance(film, table, branches, x, source, stiffening)
        if not (slope < 0.0 and tension > 0.0):
            break
        step = -force / slope
        if abs(step) < _CLOSE:
            return x + step, 2.0 * np.pi / compliance
        x += min(max(step, -_LARGEST_STEP), _LARGEST_STEP)
    return np.nan, np.nan


@njit(cache=True, error_model="numpy")
def relaxation(film: Film, table: Array, branches: Array, x: float, slopes: Array) -> None:
    """Fill ``slopes`` with dq/dt of every branch, both of shape (branches, ZONES, 2).

    ξ̇ᵣ = ξᵣ (sᵣ − sθ/2)/(3τ), s = e − 1/(eᵣ eθ), written for q = 1/ξ²: (M5).
    """
    prestretch = film.prestretch
    for k in range(ZONES):
        square_1 = (prestretch * (1.0 + table[k, 0] * (x - 1.0))) ** 2
        square_2 = (prestretch * (1.0 + table[k, 1] * (x - 1.0))) ** 2
        for i in range(branches.shape[0]):
            rate = -2.0 / (3.0 * film.branch_time[i])
            q_1, q_2 = branches[i, k, 0], branches[i, k, 1]
            elastic_1, elastic_2 = square_1 * q_1, square_2 * q_2
            pressure = 1.0 / (elastic_1 * elastic_2)
            s_1, s_2 = elastic_1 - pressure, elastic_2 - pressure
            slopes[i, k, 0] = rate * q_1 * (s_1 - 0.5 * s_2)
            slopes[i, k, 1] = rate * q_2 * (s_2 - 0.5 * s_1)
