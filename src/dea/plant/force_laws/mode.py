"""A second mass that a spring couples to the first.

The first mass moves while the second is held, then the second while the first is held. Such turns
are of second order in the motion of the first mass (G. Strang, SIAM J. Numer. Anal. 5 (1968) 506)
where each turn is: the second mass takes a midpoint step.
"""

from collections.abc import Callable

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import sliding_force
from dea.plant.force_laws.kind import Kind

HARDENING, PENDULUM, BILINEAR = 0.0, 1.0, 2.0


# Inlined, since numba does not cache a function that hands another one on.
@njit(error_model="numpy", inline="always")
def _carry_mass(
    pull: Callable[[Array, Array, float, float], float],
    c: Array, m: Array, y: float, v: float, dt: float,
) -> None:  # fmt: skip
    """Carry a mass c[0] under a force of its own place m[0] and velocity m[1] over a sub-step."""
    place, speed = m[0], m[1]
    for ahead in (0.5 * dt, dt):
        push = pull(c, m, y, v) / c[0]
        m[0], m[1] = place + ahead * m[1], speed + ahead * push


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
def _grounded(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force on the second mass, which a dashpot c[3] ties to the ground."""
    value: float = mode_force(c, m, y, v) - c[3] * m[1]
    return value


@njit(cache=True, error_model="numpy")
def carry_mode(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the second mass over a sub-step."""
    _carry_mass(_grounded, c, m, y, v, dt)


MODE = Kind(mode_force, carry_mode)


@njit(cache=True, error_model="numpy")
def linked_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass c[0] on a spring c[1] and a dashpot c[2].

    m: place and velocity of the mass.
    """
    value: float = c[1] * (y - m[0]) + c[2] * (v - m[1])
    return value


@njit(cache=True, error_model="numpy")
def column_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass c[0] on a spring c[1], damped by c[2] w + c[3] w |w|.

    w is the speed against it, m its place and velocity: F. Sakai et al., Proc. Int. Conf. Highrise
    Buildings (1989) 926.
    """
    w = v - m[1]
    value: float = linked_force(c, m, y, v) + c[3] * w * abs(w)
    return value


@njit(cache=True, error_model="numpy")
def carry_column(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the mass over a sub-step."""
    _carry_mass(column_force, c, m, y, v, dt)


COLUMN = Kind(column_force, carry_column)


@njit(cache=True, error_model="numpy")
def twin_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of two masses side by side; mass, spring and dashpot of each in c.

    T. Igusa and K. Xu, J. Sound Vib. 175 (1994) 491. m: place and velocity of each.
    """
    return linked_force(c, m, y, v) + linked_force(c[3:], m[2:], y, v)


@njit(cache=True, error_model="numpy")
def carry_twins(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry both masses over a sub-step."""
    _carry_mass(linked_force, c, m, y, v, dt)
    _carry_mass(linked_force, c[3:], m[2:], y, v, dt)


TWINS = Kind(twin_force, carry_twins)


@njit(cache=True, error_model="numpy")
def carry_series(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry a mass and another that it carries; mass, spring and dashpot of each in c.

    L. Zuo, J. Vib. Acoust. 131 (2009) 031003. m: place and velocity of each.
    """
    place, speed, carried, its_speed = m[0], m[1], m[2], m[3]
    for ahead in (0.5 * dt, dt):
        between = linked_force(c[3:], m[2:], m[0], m[1])
        push = (linked_force(c, m, y, v) - between) / c[0]
        pulled = between / c[3]
        m[0], m[2] = place + ahead * m[1], carried + ahead * m[3]
        m[1], m[3] = speed + ahead * push, its_speed + ahead * pulled


SERIES = Kind(linked_force, carry_series)


@njit(cache=True, error_model="numpy")
def rubbing_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass c[0] on a spring c[1] and a dashpot c[2], with friction c[3].

    F. Ricciardelli and B. J. Vickery, Earthq. Eng. Struct. Dyn. 28 (1999) 685. c[4]: speed of
    regularisation; m: place and velocity of the mass.
    """
    return linked_force(c, m, y, v) + sliding_force(c[3], v - m[1], c[4])


@njit(cache=True, error_model="numpy")
def carry_rubbing(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the mass over a sub-step."""
    _carry_mass(rubbing_force, c, m, y, v, dt)


RUBBING = Kind(rubbing_force, carry_rubbing)


@njit(cache=True, error_model="numpy")
def three_elements_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a mass c[0] on a spring c[1], beside it a spring c[2] on a dashpot c[3].

    T. Asami and O. Nishihara, J. Vib. Acoust. 121 (1999) 334. m: place and velocity of the mass,
    and how far the dashpot has given way.
    """
    stretch = y - m[0]
    value: float = c[1] * stretch + c[2] * (stretch - m[2])
    return value


@njit(cache=True, error_model="numpy")
def carry_three_elements(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry mass and dashpot over a sub-step."""
    place, speed, given = m[0], m[1], m[2]
    for ahead in (0.5 * dt, dt):
        push = three_elements_force(c, m, y, v) / c[0]
        giving = c[2] / c[3] * (y - m[0] - m[2])
        m[0], m[1], m[2] = place + ahead * m[1], speed + ahead * push, given + ahead * giving


THREE_ELEMENTS = Kind(three_elements_force, carry_three_elements)
