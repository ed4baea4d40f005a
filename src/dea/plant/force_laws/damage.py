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

    A power c[3] of the cycles (O. H. Basquin, Proc. ASTM 10 (1910) 625), or their logarithm where
    c[3] is zero; c[1] is the share lost after c[2] cycles.
    """
    cycles = m[0] / c[2]
    lost: float = cycles ** c[3] if c[3] > 0.0 else np.log1p(20.0 * cycles) / np.log(21.0)
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
