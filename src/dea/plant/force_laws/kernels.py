"""Kernels that several laws share."""

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
