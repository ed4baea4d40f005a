"""A ball on a dielectric elastomer film: its motion and its voltage, stepped in time.

The in-plane stretch x and the vertical stiffness k follow from :mod:`dea.plant.membrane`::

    k = 2π / ∫ dr/(r N)                                                                 (M4)
    ξ̇ᵣ = ξᵣ (sᵣ − sθ/2)/(3τ)  in every zone and branch                                  (M5)
    m ÿ = m g − c ẏ − k y − F                                                           (M6)
    d(C V)/dt = (V_amp − V)/R_e − V/R_leak,  C = ε π a² λp² x⁴/H₀                       (M7)

F is the sum of the hidden forces (:mod:`dea.plant.forces`), zero without a hidden effect. All
moduli age as 1 + r t, so do the leakage conductance and the electrode resistance. Everything is in
SI units.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.dry_friction import DRY_STEPS, is_stiff, slowed
from dea.plant.forces import Forces, total_force, update_memory
from dea.plant.membrane import (
    ZONES,
    Film,
    Source,
    capacitance,
    held,
    relaxation,
    settle,
    thickness,
    zones,
)

GRAVITY = 9.80665  # m/s²
SUBSTEP = 1e-3  # s

WHOLE, PULLED_IN, BROKEN_DOWN = 0, 1, 2

# Places in FilmState.scalars.
Y, V, FILM_VOLTAGE, TIME, FAULT, X, STIFFNESS = range(7)


class FilmState(NamedTuple):
    """What a film carries from sub-step to sub-step; the arrays change in place.

    ``scalars``, shape (7,), holds displacement (m), velocity (m/s), film voltage (V), time (s),
    fault, in-plane stretch and vertical stiffness (N/m; 0 where it is not known yet) at the places
    Y to STIFFNESS. ``branches`` holds q = 1/ξ² of every Maxwell
    branch, ``slopes`` its derivative in the middle of the last sub-step, ``middle`` is scratch
    space for its value there; all three have the shape (branches, ZONES, 2).
    """

    scalars: Array
    branches: Array
    slopes: Array
    middle: Array


@njit(cache=True, error_model="numpy")
def sourced(film: Film, scalars: Array, supply: float, dt: float) -> Source:
    """Return what charges the film over ``dt`` seconds at constant supply: (M7), exactly."""
    if scalars[FAULT] != WHOLE:
        return held(0.0)
    hours = scalars[TIME] / 3600.0
    inward = 1.0 / (film.electrode_resistance * (1.0 + film.electrode_ageing * hours))
    outward = (1.0 + film.leakage_ageing * hours) / film.leak_resistance
    total = inward + outward
    charge = scalars[FILM_VOLTAGE] * capacitance(film, scalars[X])
    return Source(inward * supply / total, charge, total * dt)


@njit(cache=True, error_model="numpy")
def stretch(film: Film, table: Array, state: FilmState, supply: float, dt: float) -> float:
    """Carry branches and film voltage over ``dt`` seconds, x to the middle of it; return k there.

    The midpoint rule for the branches, with the last slope for the first half step; the charge
    flows exactly at the capacitance in the middle. NaN where (M3) has no stable solution with the
    disc in tension.
    """
    scalars, branches, slopes, middle = state
    source = sourced(film, scalars, supply, 0.5 * dt)
    elastic = branches.shape[0] == 0 and film.stiffness_ageing == 0.0
    if elastic and scalars[FILM_VOLTAGE] == source.settled and scalars[STIFFNESS] > 0.0:
        return float(scalars[STIFFNESS])  # nothing has changed
    for i in range(branches.shape[0]):
        for k in range(ZONES):
            middle[i, k, 0] = branches[i, k, 0] + 0.5 * dt * slopes[i, k, 0]
            middle[i, k, 1] = branches[i, k, 1] + 0.5 * dt * slopes[i, k, 1]
    stiffening = 1.0 + film.stiffness_ageing * scalars[TIME] / 3600.0
    x, stiffness = settle(film, table, middle, scalars[X], source, stiffening)
    if not stiffness > 0.0:
        return np.nan
    relaxation(film, table, middle, x, slopes)
    for i in range(branches.shape[0]):
        for k in range(ZONES):
            branches[i, k, 0] += dt * slopes[i, k, 0]
            branches[i, k, 1] += dt * slopes[i, k, 1]
    load = capacitance(film, x)
    left = np.exp(-2.0 * source.passed / load)
    scalars[FILM_VOLTAGE] = source.settled * (1.0 - left) + source.charge / load * left
    scalars[X], scalars[STIFFNESS] = x, stiffness
    return stiffness


@njit(cache=True, error_model="numpy")
def move(film: Film, scalars: Array, forces: Forces | None, stiffness: float, dt: float) -> None:
    """Carry the ball over ``dt`` seconds at a constant stiffness: (M6), RK4.

    The step is divided where the dashpot alone would make it unstable. Dry friction that would is
    taken implicitly, as constant over a step.
    """
    steps = max(int(np.ceil(0.5 * dt * film.damping / film.mass)), 1)
    stiff = forces is not None and is_stiff(forces, scalars[Y], dt / steps / film.mass)
    if stiff:
        steps *= DRY_STEPS
    dt /= steps
    for _ in range(steps):
        y, v = scalars[Y], scalars[V]
        sum_y, sum_v, stage_y, stage_v = 0.0, 0.0, y, v
        for stage in range(4):
            pull = stiffness * stage_y
            if forces is not None:
                pull += total_force(forces, stage_y, 0.0 if stiff else stage_v)
            slope_y = stage_v
            slope_v = GRAVITY - (film.damping * stage_v + pull) / film.mass
            weight = 2.0 if stage in (1, 2) else 1.0
            sum_y += weight * slope_y
            sum_v += weight * slope_v
            ahead = dt if stage == 2 else 0.5 * dt
            stage_y, stage_v = y + ahead * slope_y, v + ahead * slope_v
        scalars[Y] = y + dt / 6.0 * sum_y
        scalars[V] = v + dt / 6.0 * sum_v
        if stiff and forces is not None:
            scalars[Y], scalars[V] = slowed(
                forces, scalars[Y], scalars[V], film.mass, film.damping, dt
            )


@njit(cache=True, error_model="numpy")
def advance(
    film: Film, state: FilmState, forces: Forces | None,
    supply: Array, displacement: Array, film_voltage: Array,
) -> None:  # fmt: skip
    """Advance by one sub-step per element of ``supply`` (V), filling the other two (m and V).

    The three have one shape. ``displacement[k]`` and ``film_voltage[k]`` are the values before
    ``supply[k]`` takes effect. The ball moves at the stiffness in the middle of the sub-step, so
    that the error is of second order in it. A film that pulls in, loses its tension or breaks down
    is shorted from then on: its voltage stays zero and the fault stays latched. Without ``forces``
    none of their laws is compiled.
    """
    scalars = state.scalars
    table = zones(film)
    for k in range(supply.shape[0]):
        displacement[k] = scalars[Y]
        film_voltage[k] = scalars[FILM_VOLTAGE]
        stiffness = stretch(film, table, state, supply[k], SUBSTEP)
        if not stiffness > 0.0:
            _short(scalars, PULLED_IN)
            stiffness = stretch(film, table, state, 0.0, SUBSTEP)
        move(film, scalars, forces, stiffness, SUBSTEP)
        if forces is not None:
            update_memory(forces, scalars[Y], scalars[V], SUBSTEP)
        if scalars[FAULT] == WHOLE:
            if abs(scalars[Y]) > film.pull_in_displacement:
                _short(scalars, PULLED_IN)
            elif scalars[FILM_VOLTAGE] / thickness(film, scalars[X]) > film.breakdown_field:
                _short(scalars, BROKEN_DOWN)
        scalars[TIME] += SUBSTEP


@njit(cache=True, error_model="numpy")
def _short(scalars: Array, fault: int) -> None:
    """Latch a fault and take the voltage away; the film is sought near where it was clamped."""
    scalars[FAULT], scalars[FILM_VOLTAGE], scalars[X], scalars[STIFFNESS] = fault, 0.0, 1.0, 0.0


def vertical_stiffness(film: Film) -> float:
    """Return the stiffness in N/m of the film just stretched, without voltage."""
    branches = np.ones((film.branch_modulus.size, ZONES, 2))
    stiffness: float = settle(film, zones(film), branches, 1.0, held(0.0), 1.0)[1]
    return stiffness


@njit(cache=True, error_model="numpy")
def rest(film: Film, duration: float) -> FilmState:
    """Let a freshly stretched film under its ball relax for ``duration`` seconds, without voltage.

    Such a film stays uniform, x = 1, so that every branch relaxes by itself:
    ė = −e (e − e⁻²)/(3τ) from e = λp², by RK4 with steps up to a tenth of τ. The ball follows
    quasi-statically. The displacement is NaN where it lies beyond pull-in.
    """
    count = film.branch_time.shape[0]
    branches, slopes = np.empty((count, ZONES, 2)), np.zeros((count, ZONES, 2))
    for i in range(count):
        elastic, elapsed, step = film.prestretch**2, 0.0, 1e-3
        end = min(duration / film.branch_time[i], 60.0)  # in τ; nothing is left to relax then
        while elapsed < end:
            step = min(1.05 * step, 0.1, end - elapsed)
            stage, total = elastic, 0.0
            for weight, ahead in ((1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)):
                slope = -(stage * stage - 1.0 / stage) / 3.0
                total += weight * slope
                stage = elastic + ahead * step * slope
            elastic += step / 6.0 * total
            elapsed += step
        branches[i] = elastic / film.prestretch**2
    table = zones(film)
    relaxation(film, table, branches, 1.0, slopes)
    scalars = np.zeros(7)
    scalars[X] = 1.0
    stiffness = settle(film, table, branches, 1.0, held(0.0), 1.0)[1]
    scalars[Y] = film.mass * GRAVITY / stiffness
    if scalars[Y] > film.pull_in_displacement:
        scalars[Y] = np.nan
    return FilmState(scalars, branches, slopes, np.empty_like(branches))
