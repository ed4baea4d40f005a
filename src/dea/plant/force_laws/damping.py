"""Drag, and a stiffness that is pumped."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import carry_time
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def drag_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return c[0] v |v|: J. R. Morison et al., J. Petrol. Technol. 2 (1950) 149."""
    force: float = c[0] * v * abs(v)
    return force


DRAG = Kind(drag_force)


@njit(cache=True, error_model="numpy")
def pumped_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return a stiffness c[0] about the place c[1] that comes and goes c[2] times a second.

    A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations, 1979: Mathieu's equation. m: time.
    """
    force: float = c[0] * (y - c[1]) * np.sin(2.0 * np.pi * c[2] * m[0] + c[3])
    return force


PUMPED = Kind(pumped_force, carry_time)


@njit(cache=True, error_model="numpy")
def tapered_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return a dashpot c[0] times a power c[3] of (y - c[1])/c[2], which is from 0 to 1.2.

    C. M. Harris and C. E. Crede, Shock and Vibration Handbook, 1961: a pin in an orifice.
    """
    place = min(max((y - c[1]) / c[2], 0.0), 1.2)
    force: float = c[0] * place ** c[3] * v
    return force


TAPERED = Kind(tapered_force)
