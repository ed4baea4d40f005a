"""Stops above a place c[1], which push and never pull."""

import numpy as np
from numba import njit

from dea.plant.array import Array


@njit(cache=True, error_model="numpy")
def hertz_stop(c: Array, y: float, v: float) -> float:
    """Return Hertz contact with damping that grows with the depth.

    K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.
    """
    depth = max(y - c[1], 0.0)
    force: float = c[0] * depth**1.5 * max(1.0 + c[2] * v, 0.0)
    return force


@njit(cache=True, error_model="numpy")
def padded_stop(c: Array, y: float, v: float) -> float:
    """Return a spring and dashpot in parallel that leave the stop without sticking.

    W. Goldsmith, Impact, 1960; L. Johansson's rule that the force never pulls.
    """
    depth = y - c[1]
    return max(c[0] * depth + c[2] * v, 0.0) if depth > 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def rubber_stop(c: Array, y: float) -> float:
    """Return a rubber bumper: its force grows exponentially over the depth c[2].

    P. B. Lindley, Engineering Design with Natural Rubber, 1974.
    """
    depth = max(y - c[1], 0.0) / c[2]
    force: float = c[0] * c[2] * np.expm1(min(depth, 30.0))
    return force


@njit(cache=True, error_model="numpy")
def air_cushion(c: Array, y: float) -> float:
    """Return an air cushion of length c[2], compressed with the exponent 1.4.

    ((1 - d)^-1.4 - 1) c[0] c[2]/1.4, of initial stiffness c[0]; beyond d = 0.95 a straight line.
    """
    d = max(y - c[1], 0.0) / c[2]
    inside = min(d, 0.95)
    force: float = ((1.0 - inside) ** -1.4 - 1.0) / 1.4 + (d - inside) * (1.0 - inside) ** -2.4
    value: float = c[0] * c[2] * force
    return value
