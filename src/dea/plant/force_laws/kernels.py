"""Kernels that several laws share."""

import numpy as np
from numba import njit

from dea.arrays import Array


@njit(cache=True, error_model="numpy")
def remembered_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force m[0], which the memory carries."""
    force: float = m[0]
    return force


@njit(cache=True, error_model="numpy")
def lost_force(c: Array, y: float, share: float) -> float:
    """Return what a spring c[0] that loses a share of its stiffness adds to its force."""
    force: float = -(c[0] * y * share)
    return force


@njit(cache=True, error_model="numpy")
def carry_time(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the time m[0]."""
    m[0] += dt


@njit(cache=True, error_model="numpy")
def sliding_force(friction: float, v: float, least: float) -> float:
    """Return dry friction against the velocity, regularised at the speed ``least``."""
    force: float = friction * v / np.hypot(v, least)
    return force


@njit(cache=True, error_model="numpy")
def elements_force(pairs: Array, m: Array, stretch: float) -> float:
    """Return the force of springs at a stretch less what each has given way, m.

    There are as many as m is long; ``pairs`` holds the stiffness of each and a second number.
    """
    force = 0.0
    for i in range(m.shape[0]):
        force += pairs[2 * i] * (stretch - m[i])
    return force


@njit(cache=True, error_model="numpy")
def relax_elements(pairs: Array, m: Array, stretch: float) -> None:
    """Let each of the springs give way by a share of its stretch, the second of its pair."""
    for i in range(m.shape[0]):
        m[i] += pairs[2 * i + 1] * (stretch - m[i])
