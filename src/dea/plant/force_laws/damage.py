"""Shares of the stiffness that are lost: with reversals, with the largest strain, with work."""

import math

import numpy as np
from numba import njit

from dea.plant.array import Array


@njit(cache=True, error_model="numpy")
def count_reversals(c: Array, m: Array, y: float) -> None:
    """Count half cycles: swings longer than c[4], each as its share of the swing c[5].

    m: cycles, extreme of the present swing, its start, direction.
    """
    if m[3] == 0.0:
        m[1], m[2], m[3] = y, y, 1.0
    if (y - m[1]) * m[3] > 0.0:
        m[1] = y
    elif abs(y - m[1]) > c[4]:
        m[0] += 0.5 * min(abs(m[1] - m[2]) / c[5], 1.0)
        m[2], m[1], m[3] = m[1], y, -m[3]


@njit(cache=True, error_model="numpy")
def cycle_damage(c: Array, m: Array) -> float:
    """Return the share lost after m[0] cycles.

    A power c[3] of the cycles (O. H. Basquin, Proc. ASTM 10 (1910) 625), their logarithm where
    c[3] is zero, or an exponential where it is negative (J. Lemaitre and J.-L. Chaboche, Mechanics
    of Solid Materials, 1990); c[1] is the share lost after c[2] cycles.
    """
    cycles = m[0] / c[2]
    lost: float = cycles ** c[3] if c[3] > 0.0 else np.log1p(20.0 * cycles) / np.log(21.0)
    if c[3] < 0.0:
        lost = np.expm1(c[3] * cycles) / np.expm1(c[3])
    value: float = min(c[1] * lost, 0.9)
    return value


@njit(cache=True, error_model="numpy")
def pseudo_elastic_loss(c: Array, m: Array, y: float) -> float:
    """Return 1 - η of the Mullins effect: c[1] erf((W_max - W)/(c[2] + c[3] W_max)).

    R. W. Ogden and D. G. Roxburgh, Proc. R. Soc. A 455 (1999) 2861; W = c[0] (y - c[4])²/2.
    """
    work = 0.5 * c[0] * (y - c[4]) ** 2
    most = max(m[0], work)
    value: float = c[1] * math.erf((most - work) / (c[2] + c[3] * most))
    return value


@njit(cache=True, error_model="numpy")
def work_damage(c: Array, m: Array) -> float:
    """Return c[1] W/(W + c[2]) with the accumulated work W = m[0].

    Damage driven by work: J. Lemaitre, J. Eng. Mater. Technol. 107 (1985) 83.
    """
    value: float = c[1] * m[0] / (m[0] + c[2])
    return value


@njit(cache=True, error_model="numpy")
def carry_crack(c: Array, m: Array, y: float) -> None:
    """Count half cycles in m[4], each as its share of the swing c[5] to the power c[6]."""
    before = m[0]
    count_reversals(c, m, y)
    if m[0] > before:
        m[4] += 0.5 * (2.0 * (m[0] - before)) ** c[6]


@njit(cache=True, error_model="numpy")
def crack_loss(c: Array, m: Array) -> float:
    """Return the share lost to a crack, c[1] after c[2] cycles, whose growth quickens.

    P. Paris and F. Erdogan, J. Basic Eng. 85 (1963) 528: da/dN is a power c[6] of the swing and
    the root of the length, so that a = a0 (1 - c[3] N/c[2])^(-2/(c[6] - 2)).
    """
    power = -2.0 / (c[6] - 2.0)
    grown = max(1.0 - c[3] * m[4] / c[2], 0.02) ** power - 1.0
    value: float = min(c[1] * grown / ((1.0 - c[3]) ** power - 1.0), 0.9)
    return value


@njit(cache=True, error_model="numpy")
def largest_stroke_loss(c: Array, m: Array, y: float) -> float:
    """Return c[1] (1 - (1 - exp(-x))/x) with x the largest stroke from c[3] so far over c[2].

    J. C. Simo, Comput. Methods Appl. Mech. Eng. 60 (1987) 153.
    """
    x = max(m[0], abs(y - c[3])) / c[2]
    value: float = c[1] * (1.0 + np.expm1(-x) / x) if x > 1e-9 else 0.0
    return value
