"""Drag, and a stiffness that is pumped."""

import numpy as np
from numba import njit

from dea.arrays import Array


@njit(cache=True, error_model="numpy")
def drag_force(c: Array, v: float) -> float:
    """Return c[0] v |v|: J. R. Morison et al., J. Petrol. Technol. 2 (1950) 149."""
    force: float = c[0] * v * abs(v)
    return force


@njit(cache=True, error_model="numpy")
def pumped_force(c: Array, m: Array, y: float) -> float:
    """Return a stiffness c[0] about the place c[1] that comes and goes c[2] times a second.

    A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations, 1979: Mathieu's equation. m: time.
    """
    force: float = c[0] * (y - c[1]) * np.sin(2.0 * np.pi * c[2] * m[0] + c[3])
    return force
