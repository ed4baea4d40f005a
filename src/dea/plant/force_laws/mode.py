"""A second mass that a spring couples to the first."""

import numpy as np
from numba import njit

from dea.plant.array import Array

HARDENING, PENDULUM, BILINEAR = 0.0, 1.0, 2.0


@njit(cache=True, error_model="numpy")
def _spring(c: Array, stretch: float) -> float:
    """Return the force of the spring c[1]: hardening, or the sine of a pendulum's angle.

    A bilinear one is c[4] times as stiff where it is pressed.
    """
    if c[5] == BILINEAR:
        bent: float = c[1] * (max(stretch, 0.0) + c[4] * min(stretch, 0.0))
        return bent
    if c[5] == PENDULUM:
        force: float = c[1] * c[4] * np.sin(stretch / c[4])
        return force
    value: float = c[1] * stretch * (1.0 + (stretch / c[4]) ** 2)
    return value


@njit(cache=True, error_model="numpy")
def mode_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force on the first mass; m holds place and velocity of the second.

    c: mass, spring, dashpot between the masses, dashpot to ground, length, shape of the spring.
    """
    value: float = _spring(c, y - m[0]) + c[2] * (v - m[1])
    return value


@njit(cache=True, error_model="numpy")
def carry_mode(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the second mass over a sub-step, by the symplectic Euler rule."""
    m[1] += dt / c[0] * (mode_force(c, m, y, v) - c[3] * m[1])
    m[0] += dt * m[1]


@njit(cache=True, error_model="numpy")
def column_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass c[0] on a spring c[1], damped by c[2] w + c[3] w |w|.

    w is the speed against it, m its place and velocity: F. Sakai et al., Proc. Int. Conf. Highrise
    Buildings (1989) 926.
    """
    w = v - m[1]
    value: float = c[1] * (y - m[0]) + c[2] * w + c[3] * w * abs(w)
    return value


@njit(cache=True, error_model="numpy")
def carry_column(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the mass over a sub-step, by the symplectic Euler rule."""
    m[1] += dt / c[0] * column_force(c, m, y, v)
    m[0] += dt * m[1]


@njit(cache=True, error_model="numpy")
def _twin(c: Array, m: Array, i: int, y: float, v: float) -> float:
    """Return the force of the mass ``i``."""
    value: float = c[3 * i + 1] * (y - m[2 * i]) + c[3 * i + 2] * (v - m[2 * i + 1])
    return value


@njit(cache=True, error_model="numpy")
def twin_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of two masses side by side; mass, spring and dashpot of each in c.

    T. Igusa and K. Xu, J. Sound Vib. 175 (1994) 491. m: place and velocity of each.
    """
    value: float = _twin(c, m, 0, y, v) + _twin(c, m, 1, y, v)
    return value


@njit(cache=True, error_model="numpy")
def carry_twins(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry both masses over a sub-step, by the symplectic Euler rule."""
    for i in range(2):
        m[2 * i + 1] += dt / c[3 * i] * _twin(c, m, i, y, v)
        m[2 * i] += dt * m[2 * i + 1]


@njit(cache=True, error_model="numpy")
def series_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass that carries another; mass, spring and dashpot of each in c.

    L. Zuo, J. Vib. Acoust. 131 (2009) 031003. m: place and velocity of each.
    """
    value: float = _twin(c, m, 0, y, v)
    return value


@njit(cache=True, error_model="numpy")
def carry_series(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry both masses over a sub-step, by the symplectic Euler rule."""
    between = _twin(c, m, 1, m[0], m[1])
    m[1] += dt / c[0] * (_twin(c, m, 0, y, v) - between)
    m[3] += dt / c[3] * between
    m[0] += dt * m[1]
    m[2] += dt * m[3]
