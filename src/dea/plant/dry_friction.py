"""Dry friction over a step of a device, taken implicitly: it is steep near standstill.

An explicit step would chatter there, and friction would act on fast motion alone.
"""

import numpy as np
from numba import njit

from dea.plant.forces import Forces, total_force

# Parts of a step where friction is taken implicitly, which is of first order.
DRY_STEPS = 8
# A speed, in the plant's units, at which no friction is anything but linear.
_CRAWL = 1e-9
# Precision of the velocity that an implicit step solves for, and evaluations at most.
_PRECISION, _ITERATIONS = 1e-9, 60


@njit(cache=True, error_model="numpy")
def is_stiff(forces: Forces, y: float, velocity: float) -> bool:
    """Return whether friction would change a velocity by more than itself within a step.

    It is steepest at standstill. ``velocity`` is what a newton gives in the step.
    """
    rise = total_force(forces, y, _CRAWL) - total_force(forces, y, -_CRAWL)
    return bool(velocity * rise > 2.0 * _CRAWL)


@njit(cache=True, error_model="numpy")
def slowed(
    forces: Forces, y: float, v: float, mass: float, damping: float, dt: float
) -> tuple[float, float]:
    """Return place and velocity of a mass on a dashpot after ``dt`` seconds, with friction.

    ``y`` and ``v`` are those that it has without.
    """
    velocity, way = _pushed(mass, damping, dt)
    dry = _friction(forces, y, v, velocity)
    return y - dry * way, v - dry * velocity


@njit(cache=True, error_model="numpy")
def _pushed(mass: float, damping: float, dt: float) -> tuple[float, float]:
    """Return the velocity and the way that a newton gives a mass on a dashpot in ``dt`` seconds."""
    decay = damping / mass * dt
    if decay < 1e-4:
        return dt / mass, 0.5 * dt * dt / mass
    velocity = -np.expm1(-decay) / damping
    return velocity, (dt - mass * velocity) / damping


@njit(cache=True, error_model="numpy")
def _friction(forces: Forces, y: float, v: float, velocity: float) -> float:
    """Return the friction over a step, which is that at the step's end.

    ``v`` is the velocity there without friction and ``velocity`` what a newton gives in the step.
    The end is between standstill and ``v``, for friction opposes the motion: by the Illinois
    method.
    """
    static = total_force(forces, y, 0.0)
    low, high = 0.0, v
    at_low, at_high = -v, velocity * (total_force(forces, y, v) - static)
    if at_high * v <= 0.0:
        return at_high / velocity
    for _ in range(_ITERATIONS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        at_middle = middle - v + velocity * (total_force(forces, y, middle) - static)
        if at_middle * at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        high, at_high = middle, at_middle
        if abs(at_middle) <= _PRECISION * abs(v):
            break
    return (v - high) / velocity
