"""Forces on a moving mass besides its own device's, evaluated inside the equation of motion.

A force law is a kind, a row of constants and a row of memory. Its force depends on displacement
and velocity at constant memory, so that it can be evaluated within a Runge-Kutta step; its memory
is updated once per sub-step. Forces are in N, positive where they oppose a growing displacement;
a rotating device has torques and angles in their place.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dea.arrays import Array, Indices
from dea.plant.array import Values
from dea.plant.force_laws.kind import Kind, carry_at, force_at

WIDTH = 64  # length of a row of constants or memory


class Forces(NamedTuple):
    """Several laws, as compiled code takes them.

    ``addresses``, shape (laws, 2), holds where force and memory of each are compiled, valid in
    this process alone; ``constants`` and ``memory`` have the shape (laws, WIDTH).
    """

    addresses: Indices
    constants: Array
    memory: Array


class ForceLaw(NamedTuple):
    """One law: its kind, and the beginnings of its rows of constants and memory; the rest is 0."""

    kind: Kind
    constants: Values
    memory: Values = ()


def stack(laws: list[ForceLaw]) -> Forces:
    """Return the laws as the arrays that the equation of motion takes."""
    addresses = np.zeros((len(laws), 2), dtype=np.int64)
    constants, memory = np.zeros((len(laws), WIDTH)), np.zeros((len(laws), WIDTH))
    for row, law in enumerate(laws):
        addresses[row] = law.kind.addresses()
        constants[row, : len(law.constants)] = law.constants
        memory[row, : len(law.memory)] = law.memory
    return Forces(addresses, constants, memory)


@njit(cache=True, error_model="numpy")
def total_force(forces: Forces, y: float, v: float) -> float:
    """Return the sum of all forces, in N, at displacement ``y`` (m) and velocity ``v`` (m/s)."""
    total = 0.0
    for row in range(forces.addresses.shape[0]):
        force = force_at(forces.addresses[row, 0])
        total += force(forces.constants[row], forces.memory[row], y, v)
    return total


@njit(cache=True, error_model="numpy")
def update_memory(forces: Forces, y: float, v: float, dt: float) -> None:
    """Carry every law's memory over ``dt`` seconds; ``y`` and ``v`` are the values at their end."""
    for row in range(forces.addresses.shape[0]):
        carry = carry_at(forces.addresses[row, 1])
        carry(forces.constants[row], forces.memory[row], y, v, dt)
