"""A mass on a cone-shaped dielectric elastomer film: the equations of motion and their stepping.

The vertical displacement y of the mass stretches a film of prestretch λp between a contact of
radius a and a frame of radius b = a + L::

    λ₁ = λp √(1 + y²/L²),  λ₂ = λp,  h = H₀/(λ₁λ₂),  Ω = π(b² − a²) H₀/λp²          (M1)
    m ÿ = m g − c ẏ − Ω σ₁ y/(L² + y²) − F                                          (M2)
    σ₁ = 2 W′(I₁)(λ₁² − λ₁⁻²λ₂⁻²) + Σᵢ μᵢ(λₑ₁² − λₑ₁⁻²λₑ₂⁻²) − ε₀εᵣ(V/h)²           (M3)
    ξ̇₁ = ξ₁(s₁ − s₂/2)/(3τ),  λₑⱼ = λⱼ/ξⱼ,  sⱼ = λₑⱼ² − (λₑ₁λₑ₂)⁻²                  (M4)
    d(C V)/dt = (V_amp − V)/R_e − V/R_leak,  C = ε₀εᵣ Ω/h²                           (M5)

W is Yeoh's strain energy (Yeoh, Rubber Chem. Technol. 66, 1993), the branches are Maxwell elements
with strain-like internal variables (Reese and Govindjee, Int. J. Solids Struct. 35, 1998), the
electrostatic stress is Suo's (Acta Mech. Solida Sin. 23, 2010). ξ₂ follows (M4) with the
directions swapped. F is the sum of the hidden forces (:mod:`dea.plant.forces`), zero without a
hidden effect. Everything is in SI units.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.plant.array import Array
from dea.plant.forces import Forces, total_force, update_memory

EPSILON_0 = 8.8541878128e-12  # F/m
GRAVITY = 9.80665  # m/s²
SUBSTEP = 1e-3  # s

WHOLE, PULLED_IN, BROKEN_DOWN = 0, 1, 2

# Places in FilmState.scalars.
Y, V, FILM_VOLTAGE, TIME, FAULT = range(5)


class Film(NamedTuple):
    """The parameters of one film, its mass and its electrodes (SI units)."""

    frame_radius: float
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


class FilmState(NamedTuple):
    """What a film carries from sub-step to sub-step; both arrays change in place.

    ``scalars``, shape (5,), holds displacement (m), velocity (m/s), film voltage (V), time (s) and
    fault at the places Y, V, FILM_VOLTAGE, TIME and FAULT; ``branches`` holds 1/ξ² of every Maxwell
    branch, shape (branches, 2).
    """

    scalars: Array
    branches: Array


@njit(cache=True, error_model="numpy")
def tension(film: Film, branches: Array, y: float, voltage: float, stiffening: float) -> float:
    """Return the vertical force of the film on the mass, in N, upwards positive: (M1)-(M3).

    ``branches`` holds 1/ξ² of every Maxwell branch, shape (branches, 2); ``stiffening`` scales
    all elastic moduli.
    """
    width = film.frame_radius - film.contact_radius
    area = np.pi * (film.frame_radius**2 - film.contact_radius**2)
    square_p = film.prestretch * film.prestretch
    square_1 = square_p * (1.0 + (y / width) ** 2)
    squares = square_1 * square_p
    strain = square_1 + square_p + 1.0 / squares - 3.0
    slope = film.yeoh_1 + strain * (2.0 * film.yeoh_2 + 3.0 * strain * film.yeoh_3)
    stress = 2.0 * slope * (square_1 - 1.0 / squares)
    for i in range(branches.shape[0]):
        elastic_1 = square_1 * branches[i, 0]
        elastic_2 = square_p * branches[i, 1]
        stress += film.branch_modulus[i] * (elastic_1 - 1.0 / (elastic_1 * elastic_2))
    field_square = voltage * voltage * squares / (film.thickness * film.thickness)
    stress = stiffening * stress - EPSILON_0 * film.permittivity * field_square  # (M3)
    volume = area * film.thickness / square_p
    return volume * stress * y / (width * width + y * y)


@njit(cache=True, error_model="numpy")
def creep(film: Film, branches: Array, y: float, dt: float) -> None:
    """Carry every Maxwell branch over ``dt`` seconds at a held displacement: (M4), midpoint rule.

    Written for q = 1/ξ², which is what the stress needs: q̇₁ = −2 q₁ (s₁ − s₂/2)/(3τ).
    """
    width = film.frame_radius - film.contact_radius
    square_p = film.prestretch * film.prestretch
    square_1 = square_p * (1.0 + (y / width) ** 2)
    for i in range(branches.shape[0]):
        rate = -2.0 / (3.0 * film.branch_time[i])
        q_1, q_2 = branches[i, 0], branches[i, 1]
        middle_1, middle_2 = q_1, q_2
        for share in (0.5, 1.0):
            elastic_1, elastic_2 = square_1 * middle_1, square_p * middle_2
            pressure = 1.0 / (elastic_1 * elastic_2)
            s_1, s_2 = elastic_1 - pressure, elastic_2 - pressure
            slope_1 = rate * middle_1 * (s_1 - 0.5 * s_2)
            slope_2 = rate * middle_2 * (s_2 - 0.5 * s_1)
            middle_1, middle_2 = q_1 + share * dt * slope_1, q_2 + share * dt * slope_2
        branches[i, 0], branches[i, 1] = middle_1, middle_2


@njit(cache=True, error_model="numpy")
def thickness(film: Film, y: float) -> float:
    """Return the thickness h of the stretched film in m: (M1)."""
    width = film.frame_radius - film.contact_radius
    value: float = film.thickness / (film.prestretch**2 * np.sqrt(1.0 + (y / width) ** 2))
    return value


@njit(cache=True, error_model="numpy")
def capacitance(film: Film, y: float) -> float:
    """Return the capacitance of the film in F: (M5)."""
    area = np.pi * (film.frame_radius**2 - film.contact_radius**2)
    volume = area * film.thickness / film.prestretch**2
    return EPSILON_0 * film.permittivity * volume / thickness(film, y) ** 2


@njit(cache=True, error_model="numpy")
def charge(film: Film, scalars: Array, supply: float, dt: float) -> None:
    """Carry the film voltage over ``dt`` seconds at constant supply and motion: (M5), exactly."""
    y, hours = scalars[Y], scalars[TIME] / 3600.0
    width = film.frame_radius - film.contact_radius
    growth = 2.0 * y * scalars[V] / (width * width + y * y)  # Ċ/C
    in_rate = 1.0 / (film.electrode_resistance * (1.0 + film.electrode_ageing * hours))
    out_rate = (1.0 + film.leakage_ageing * hours) / film.leak_resistance
    rate = (in_rate + out_rate) / capacitance(film, y) + growth
    settled = in_rate * supply / (capacitance(film, y) * rate)
    scalars[FILM_VOLTAGE] = settled + (scalars[FILM_VOLTAGE] - settled) * np.exp(-rate * dt)


@njit(cache=True, error_model="numpy")
def move(film: Film, state: FilmState, forces: Forces, dt: float) -> None:
    """Carry the mass over ``dt`` seconds at constant film voltage and branches: (M2), RK4.

    The step is divided where the dashpot alone would make it unstable.
    """
    scalars, branches = state
    stiffening = 1.0 + film.stiffness_ageing * scalars[TIME] / 3600.0
    voltage = scalars[FILM_VOLTAGE]
    disturbed = forces.kind.shape[0] > 0
    steps = max(int(np.ceil(0.5 * dt * film.damping / film.mass)), 1)
    dt /= steps
    for _ in range(steps):
        y, v = scalars[Y], scalars[V]
        sum_y, sum_v, stage_y, stage_v = 0.0, 0.0, y, v
        for stage in range(4):
            pull = tension(film, branches, stage_y, voltage, stiffening)
            if disturbed:
                pull += total_force(forces, stage_y, stage_v)
            slope_y = stage_v
            slope_v = GRAVITY - (film.damping * stage_v + pull) / film.mass
            weight = 2.0 if stage in (1, 2) else 1.0
            sum_y += weight * slope_y
            sum_v += weight * slope_v
            ahead = dt if stage == 2 else 0.5 * dt
            stage_y, stage_v = y + ahead * slope_y, v + ahead * slope_v
        scalars[Y] = y + dt / 6.0 * sum_y
        scalars[V] = v + dt / 6.0 * sum_v


@njit(cache=True, error_model="numpy")
def advance(
    film: Film, state: FilmState, forces: Forces,
    supply: Array, displacement: Array, film_voltage: Array,
) -> None:  # fmt: skip
    """Advance by one sub-step per element of ``supply`` (V), filling the other two (m and V).

    The three have one shape. ``displacement[k]`` and ``film_voltage[k]`` are the values before
    ``supply[k]`` takes effect. Electrical and mechanical steps are interleaved symmetrically, so
    that the error is of second order in the sub-step. A film that pulls in or breaks down is
    shorted from then on: its voltage stays zero and the fault stays latched.
    """
    scalars = state.scalars
    for k in range(supply.shape[0]):
        displacement[k] = scalars[Y]
        film_voltage[k] = scalars[FILM_VOLTAGE]
        creep(film, state.branches, scalars[Y], SUBSTEP)
        if scalars[FAULT] == WHOLE:
            charge(film, scalars, supply[k], 0.5 * SUBSTEP)
        move(film, state, forces, SUBSTEP)
        if forces.kind.shape[0] > 0:
            update_memory(forces, scalars[Y], scalars[V], SUBSTEP)
        if scalars[FAULT] == WHOLE:
            charge(film, scalars, supply[k], 0.5 * SUBSTEP)
            field = scalars[FILM_VOLTAGE] / thickness(film, scalars[Y])
            if abs(scalars[Y]) > film.pull_in_displacement:
                scalars[FAULT], scalars[FILM_VOLTAGE] = PULLED_IN, 0.0
            elif field > film.breakdown_field:
                scalars[FAULT], scalars[FILM_VOLTAGE] = BROKEN_DOWN, 0.0
        scalars[TIME] += SUBSTEP


@njit(cache=True, error_model="numpy")
def equilibrium(film: Film, branches: Array) -> float:
    """Return the displacement in m at which the film without voltage carries the mass."""
    low, high = 0.0, film.pull_in_displacement
    weight = film.mass * GRAVITY
    if tension(film, branches, high, 0.0, 1.0) < weight:
        return np.nan
    for _ in range(60):
        middle = 0.5 * (low + high)
        if tension(film, branches, middle, 0.0, 1.0) < weight:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@njit(cache=True, error_model="numpy")
def rest(film: Film, branches: Array, duration: float) -> float:
    """Let a freshly stretched film under its mass relax for ``duration`` seconds, without voltage.

    The mass follows quasi-statically. Steps grow from a millisecond to a quarter of the shortest
    time constant, beyond which the midpoint rule would not be stable. Returns the displacement.
    """
    branches[:] = 1.0
    step, elapsed = SUBSTEP, 0.0
    longest = 0.25 * film.branch_time.min() if film.branch_time.size else duration
    y = equilibrium(film, branches)
    while elapsed < duration and y == y:
        step = min(1.01 * step, longest, duration - elapsed)
        half = branches.copy()
        creep(film, half, y, 0.5 * step)
        creep(film, branches, equilibrium(film, half), step)
        elapsed += step
        y = equilibrium(film, branches)
    return y
