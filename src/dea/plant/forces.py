"""Forces on the mass besides the film's own, evaluated inside its equation of motion.

A force law is a kind, a row of constants and a row of memory. Its force depends on displacement
and velocity at constant memory, so that it can be evaluated within a Runge-Kutta step; its memory
is updated once per sub-step. Forces are in N, positive where they oppose a growing displacement.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.plant.array import Array

WIDTH = 64  # length of a row of constants or memory

(
    POWER_LAW_CREEP,
    MASING_HYSTERESIS,
    LUGRE_FRICTION,
    FUNG_STIFFENING,
    PATH_SOFTENING,
    ATTACHED_MASS,
    HERTZ_STOP,
    STIFFNESS_STEP,
    SNAP_THROUGH,
) = range(9)


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
        if kind == POWER_LAW_CREEP:
            total += _creep_force(c, m, y)
        elif kind == MASING_HYSTERESIS:
            total += _hysteresis_force(c, m, y)
        elif kind == LUGRE_FRICTION:
            total += c[0] * m[0] + c[1] * (v - c[0] * abs(v) * m[0] / _stribeck(c, v))
        elif kind == FUNG_STIFFENING:
            stretch = (y - c[2]) / c[1]
            total += c[0] * (np.exp(stretch) - 1.0 - stretch)
        elif kind == PATH_SOFTENING:
            total -= c[0] * y * c[1] * (1.0 - np.exp(-((m[0] / c[2]) ** c[3])))
        elif kind == ATTACHED_MASS:
            stretch = y - m[0]
            total += c[1] * stretch * (1.0 + (stretch / c[3]) ** 2) + c[2] * (v - m[1])
        elif kind == HERTZ_STOP:
            depth = max(y - c[1], 0.0)
            total += c[0] * depth**1.5 * max(1.0 + c[2] * v, 0.0)
        elif kind == STIFFNESS_STEP:
            total += c[0] * y / (1.0 + np.exp(-(m[0] - c[1]) / c[2]))
        elif kind == SNAP_THROUGH:
            place = (y - c[1]) / c[2]
            total += c[0] * np.sin(2.0 * np.pi * place) * np.exp(-place * place)
    return total


@njit(cache=True, error_model="numpy")
def update_memory(forces: Forces, y: float, v: float, dt: float) -> None:
    """Carry every law's memory over ``dt`` seconds; ``y`` and ``v`` are the values at their end."""
    for row in range(forces.kind.shape[0]):
        kind, c, m = forces.kind[row], forces.constants[row], forces.memory[row]
        if kind == POWER_LAW_CREEP:
            for i in range(int(c[0])):
                m[i] += c[2 + 2 * i] * (y - m[i])
        elif kind == MASING_HYSTERESIS:
            _note_reversals(m, y)
        elif kind == LUGRE_FRICTION:
            # Implicit in the bristle deflection, which is stiff at high speed.
            m[0] = (m[0] + v * dt) / (1.0 + c[0] * abs(v) * dt / _stribeck(c, v))
        elif kind == PATH_SOFTENING:
            m[0] += abs(v) * dt
        elif kind == ATTACHED_MASS:
            stretch = y - m[0]
            push = c[1] * stretch * (1.0 + (stretch / c[3]) ** 2) + c[2] * (v - m[1])
            m[1] += dt * push / c[0]
            m[0] += dt * m[1]
        elif kind == STIFFNESS_STEP:
            m[0] += dt


@njit(cache=True, error_model="numpy")
def _creep_force(c: Array, m: Array, y: float) -> float:
    """Power-law relaxation as a dense spectrum of modes; c holds (stiffness, share) pairs."""
    force = 0.0
    for i in range(int(c[0])):
        force += c[1 + 2 * i] * (y - m[i])
    return force


@njit(cache=True, error_model="numpy")
def _stribeck(c: Array, v: float) -> float:
    """Steady friction force of the LuGre model at velocity ``v``."""
    force: float = c[2] + (c[3] - c[2]) * np.exp(-((v / c[4]) ** 2))
    return force


@njit(cache=True, error_model="numpy")
def _branch(c: Array, start: float, end: float) -> float:
    """Force gained along a monotonic path between two displacements, by Masing's rule.

    The slope falls along the path, and is larger away from the middle of the travel.
    """
    length = abs(end - start)
    middle = (0.5 * (start + end) - c[2]) / c[3]
    gained: float = c[0] * length / (1.0 + length / c[1]) * (1.0 + middle * middle)
    return gained if end > start else -gained


@njit(cache=True, error_model="numpy")
def _hysteresis_force(c: Array, m: Array, y: float) -> float:
    """m[0] is the number of reversals in memory; they follow it, the start of the motion first."""
    count = int(m[0])
    end = y if count == 1 else m[2]
    force = 0.5 * _branch(c, 2.0 * m[1] - end, end)  # the virgin curve, by Masing's rule
    for i in range(2, count):
        force += _branch(c, m[i], m[i + 1])
    return force + _branch(c, m[count], y) if count > 1 else force


@njit(cache=True, error_model="numpy")
def _note_reversals(m: Array, y: float) -> None:
    """Update the reversals that still act on the force; m[-1] is the latest displacement."""
    count, latest = int(m[0]), m[-1]
    turned = (y - latest) * (latest - m[count]) < 0.0
    if turned and count < m.shape[0] - 3:
        count += 1
        m[count] = latest
    # A larger swing erases the smaller ones.
    while count >= 3 and (y - m[count - 1]) * (m[count - 1] - m[count]) > 0.0:
        count -= 2
    if count == 2 and abs(y - m[1]) > abs(m[2] - m[1]):
        count = 1
    m[0], m[m.shape[0] - 1] = count, y
