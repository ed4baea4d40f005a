"""Hysteresis that does not depend on rate, with a memory of reversals.

In the memory, m[0] is the number of reversals; they follow it, the start of the motion first.
"""

from collections.abc import Callable

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kind import Kind


# Inlined, since numba does not cache a function that hands another one on.
@njit(error_model="numpy", inline="always")
def _along_branches(
    branch: Callable[[Array, float, float], float], c: Array, m: Array, y: float
) -> float:
    """Return the force after branches from reversal to reversal, half of one at the start."""
    count = int(m[0])
    end = y if count == 1 else m[2]
    force = 0.5 * branch(c, 2.0 * m[1] - end, end)  # the virgin curve
    for i in range(2, count):
        force += branch(c, m[i], m[i + 1])
    return force + branch(c, m[count], y) if count > 1 else force


@njit(cache=True, error_model="numpy")
def masing_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force by Masing's rule, from the reversals in memory."""
    return _along_branches(_masing_branch, c, m, y)


@njit(cache=True, error_model="numpy")
def _masing_branch(c: Array, start: float, end: float) -> float:
    """Return the force gained on a monotonic path, whose slope c[0] falls along it.

    Around the length c[1] it falls to a share c[5], the more sharply the higher c[4] (M. Menegotto
    and P. E. Pinto, IABSE Symposium Lisbon (1973) 15); branches are stiffer by the square of their
    distance from the place c[2] over c[3]. Where c[6] is 1, the length is f + f^c[4] for the force
    f instead (W. Ramberg and W. R. Osgood, NACA Technical Note 902, 1943), both over their scales.
    Where it is 2, springs of a share c[5] of c[0] slip by and by up to the length c[1], as many as
    its power c[4], and the others all there (D. J. Segalman, J. Appl. Mech. 72 (2005) 752).
    """
    length = abs(end - start)
    middle = (0.5 * (start + end) - c[2]) / c[3]
    if c[6] == 1.0:
        bent = _ramberg_osgood(length / c[1], c[4])
    elif c[6] == 2.0:
        bent = _slipping_joint(length / c[1], c[4], c[5])
    else:
        bent = c[5] + (1.0 - c[5]) / (1.0 + (length / c[1]) ** c[4]) ** (1.0 / c[4])
    gained: float = c[0] * length * bent * (1.0 + middle * middle)
    return gained if end > start else -gained


@njit(cache=True, error_model="numpy")
def _ramberg_osgood(x: float, order: float) -> float:
    """Return f/x for f + f^order = x, by Newton's rule from above."""
    if x < 1e-9:
        return 1.0
    f: float = min(x, x ** (1.0 / order))
    for _ in range(12):
        power = f ** (order - 1.0)
        f -= (f + f * power - x) / (1.0 + order * power)
    return f / x


@njit(cache=True, error_model="numpy")
def _slipping_joint(x: float, power: float, share: float) -> float:
    """Return force over length of springs that have slipped up to x, 1 where none has."""
    inside = min(x, 1.0)
    held: float = 1.0 - share * inside**power / (1.0 + power)
    return held if x < 1.0 else held / x


@njit(cache=True, error_model="numpy")
def preisach_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of Preisach's model with the same memory of reversals.

    A density that is a product of Lorentzians has the Everett function (Φ(a) - Φ(b))²/2 with Φ the
    arcus tangent of the place (Biorci and Pescetti, Nuovo Cimento 7, 1958; Mayergoyz, Mathematical
    Models of Hysteresis, 1991). With the usual sign, a force that lags behind the position would
    add energy; here the sign is reversed. c: height, middle and width of the density.
    """
    return _along_branches(_everett, c, m, y)


@njit(cache=True, error_model="numpy")
def _everett(c: Array, start: float, end: float) -> float:
    difference = np.arctan((end - c[1]) / c[2]) - np.arctan((start - c[1]) / c[2])
    value: float = -0.5 * c[0] * difference * abs(difference)
    return value


@njit(cache=True, error_model="numpy")
def note_reversals(c: Array, m: Array, y: float, v: float, dt: float) -> None:
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


PREISACH = Kind(preisach_force, note_reversals)


MASING = Kind(masing_force, note_reversals)
