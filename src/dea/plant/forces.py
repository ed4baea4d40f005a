"""Forces on a moving mass besides its own device's, evaluated inside the equation of motion.

A force law is a kind, a row of constants and a row of memory. Its force depends on displacement
and velocity at constant memory, so that it can be evaluated within a Runge-Kutta step; its memory
is updated once per sub-step. Forces are in N, positive where they oppose a growing displacement;
a rotating device has torques and angles in their place.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.plant.array import Array
from dea.plant.force_laws.contact import (
    air_cushion,
    hertz_stop,
    padded_stop,
    rubber_stop,
)
from dea.plant.force_laws.damage import (
    count_reversals,
    cycle_damage,
    pseudo_elastic_loss,
    work_damage,
)
from dea.plant.force_laws.elastic import (
    chain_force,
    fung_force,
    gent_force,
    power_force,
    snap_force,
)
from dea.plant.force_laws.friction import (
    bristle_force,
    carry_bristle,
    carry_dahl,
    composite_friction,
    stribeck_friction,
)
from dea.plant.force_laws.hysteresis import (
    carry_bouc_wen,
    carry_duhem,
    masing_force,
    note_reversals,
    preisach_force,
)
from dea.plant.force_laws.in_time import force_in_time, pulse_train, stiffness_in_time
from dea.plant.force_laws.mode import carry_mode, mode_force
from dea.plant.force_laws.viscoelastic import (
    carry_eyring,
    carry_spectrum,
    spectrum_force,
)

WIDTH = 64  # length of a row of constants or memory

(
    SPECTRUM,
    EYRING,
    MASING,
    PREISACH,
    BOUC_WEN,
    DUHEM,
    LUGRE,
    DAHL,
    STRIBECK,
    COMPOSITE,
    FUNG,
    GENT,
    CHAIN,
    POWER,
    CYCLES,
    PSEUDO_ELASTIC,
    WORK,
    MODE,
    HERTZ,
    PADDED,
    RUBBER,
    CUSHION,
    STIFFNESS_COURSE,
    FORCE_COURSE,
    PULSES,
    SNAP_THROUGH,
) = range(26)


class Forces(NamedTuple):
    """Several laws: kinds of shape (laws,), constants and memory of shape (laws, WIDTH)."""

    kind: NDArray[np.int64]
    constants: Array
    memory: Array


class ForceLaw(NamedTuple):
    """One law: its kind, its constants and its initial memory, each at most WIDTH long."""

    kind: int
    constants: Array
    memory: Array


def stack(laws: list[ForceLaw]) -> Forces:
    """Return the laws as the arrays that the equation of motion takes."""
    constants, memory = np.zeros((len(laws), WIDTH)), np.zeros((len(laws), WIDTH))
    for row, law in enumerate(laws):
        constants[row, : law.constants.size] = law.constants
        memory[row, : law.memory.size] = law.memory
    return Forces(np.array([law.kind for law in laws], dtype=np.int64), constants, memory)


@njit(cache=True, error_model="numpy")
def total_force(forces: Forces, y: float, v: float) -> float:
    """Return the sum of all forces, in N, at displacement ``y`` (m) and velocity ``v`` (m/s)."""
    total = 0.0
    for row in range(forces.kind.shape[0]):
        kind, c, m = forces.kind[row], forces.constants[row], forces.memory[row]
        if kind == SPECTRUM:
            total += spectrum_force(c, m, y)
        elif kind == EYRING:
            total += c[0] * (y - m[0])
        elif kind == MASING:
            total += masing_force(c, m, y)
        elif kind == PREISACH:
            total += preisach_force(c, m, y)
        elif kind == BOUC_WEN:
            total += c[0] * m[0]
        elif kind in (DUHEM, DAHL):
            total += m[0]
        elif kind == LUGRE:
            total += bristle_force(c, m, v)
        elif kind == STRIBECK:
            total += stribeck_friction(c, v)
        elif kind == COMPOSITE:
            total += composite_friction(c, v)
        elif kind == FUNG:
            total += fung_force(c, y)
        elif kind == GENT:
            total += gent_force(c, y)
        elif kind == CHAIN:
            total += chain_force(c, y)
        elif kind == POWER:
            total += power_force(c, y)
        elif kind == CYCLES:
            total -= c[0] * y * cycle_damage(c, m)
        elif kind == PSEUDO_ELASTIC:
            total -= c[0] * (y - c[4]) * pseudo_elastic_loss(c, m, y)
        elif kind == WORK:
            total -= c[0] * y * work_damage(c, m)
        elif kind == MODE:
            total += mode_force(c, m, y, v)
        elif kind == HERTZ:
            total += hertz_stop(c, y, v)
        elif kind == PADDED:
            total += padded_stop(c, y, v)
        elif kind == RUBBER:
            total += rubber_stop(c, y)
        elif kind == CUSHION:
            total += air_cushion(c, y)
        elif kind == STIFFNESS_COURSE:
            total += stiffness_in_time(c, m, y)
        elif kind == FORCE_COURSE:
            total += force_in_time(c, m)
        elif kind == PULSES:
            total += pulse_train(c, m)
        elif kind == SNAP_THROUGH:
            total += snap_force(c, y)
    return total


@njit(cache=True, error_model="numpy")
def update_memory(forces: Forces, y: float, v: float, dt: float) -> None:
    """Carry every law's memory over ``dt`` seconds; ``y`` and ``v`` are the values at their end."""
    for row in range(forces.kind.shape[0]):
        kind, c, m = forces.kind[row], forces.constants[row], forces.memory[row]
        if kind == SPECTRUM:
            carry_spectrum(c, m, y)
        elif kind == EYRING:
            carry_eyring(c, m, y, dt)
        elif kind in (MASING, PREISACH):
            note_reversals(m, y)
        elif kind == BOUC_WEN:
            carry_bouc_wen(c, m, y)
        elif kind == DUHEM:
            carry_duhem(c, m, y)
        elif kind == LUGRE:
            carry_bristle(c, m, v, dt)
        elif kind == DAHL:
            carry_dahl(c, m, y)
        elif kind == CYCLES:
            count_reversals(c, m, y)
        elif kind == PSEUDO_ELASTIC:
            m[0] = max(m[0], 0.5 * c[0] * (y - c[4]) ** 2)
        elif kind == WORK:
            m[0] += c[0] * abs((y - c[3]) * v) * dt
        elif kind == MODE:
            carry_mode(c, m, y, v, dt)
        elif kind in (STIFFNESS_COURSE, FORCE_COURSE, PULSES):
            m[0] += dt
