"""One compiled integrator for every simulation and every force-balance effect.

Simulations and effects enter as first-class functions of fixed signatures, so that neither a new
effect nor a new parameter compiles anything.
"""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import float64, int64, njit, types
from numba.core.errors import NumbaExperimentalFeatureWarning

# First-class functions are what keeps this to one compilation.
warnings.filterwarnings("ignore", category=NumbaExperimentalFeatureWarning)

_VECTOR = types.Array(float64, 1, "C")
_MATRIX = types.Array(float64, 2, "C")
_INDEX = types.Array(int64, 2, "C")
DERIVATIVE = types.void(_VECTOR, float64, _VECTOR, _VECTOR)
OUTPUT = float64(_VECTOR, float64, _VECTOR)
FORCE = float64(float64, float64, _VECTOR, _VECTOR)
UPDATE = types.void(float64, float64, float64, _VECTOR, _VECTOR)

SLOTS = 3
MEMORY = 12


def compiled(function: Callable[..., Any], signature: Any) -> Any:
    """Compile ``function`` for ``signature``; a function that is compiled already is returned."""
    if hasattr(function, "nopython_signatures"):
        return function
    return njit(signature)(function)


@njit(FORCE, cache=True)
def no_force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Fill an empty slot."""
    return 0.0


@njit(UPDATE, cache=True)
def no_update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Fill the slot of a force without memory."""


@njit(types.void(_VECTOR, _INDEX, _MATRIX, _VECTOR), cache=True)
def _positions(x, ports, frames, z):
    """Write the normalised position of each port that has one."""
    for e in range(SLOTS + 1):
        if ports[e, 1] >= 0:
            z[e] = (x[ports[e, 1]] - frames[e, 0]) / frames[e, 1]


_F, _U = types.FunctionType(FORCE), types.FunctionType(UPDATE)


@njit(
    _MATRIX(
        types.FunctionType(DERIVATIVE), types.FunctionType(OUTPUT), _F, _U, _F, _U, _F, _U, int64,
        _VECTOR, int64, _VECTOR, int64, _VECTOR, _VECTOR, float64, int64,
        _INDEX, _MATRIX, _MATRIX, _MATRIX,
    ),
    cache=True,
    nogil=True,
)  # fmt: skip
def integrate(
    derivative,
    output,
    force_1,
    update_1,
    force_2,
    update_2,
    force_3,
    update_3,
    forces,
    u,
    linear_hold,
    p,
    drive,
    drive_scale,
    x0,
    interval,
    substeps,
    ports,
    frames,
    memory,
    q,
):
    """Integrate by the classical Runge-Kutta method with a fixed step of ``interval/substeps``.

    Effects with memory are split off: within a step the force is evaluated with the memory of
    the step's start, which is then brought up to date with the motion over the step.

    Parameters
    ----------
    u : (n,)
        Input; held over each interval, or interpolated if ``linear_hold``.
    drive, drive_scale : int, (n,)
        Index of the parameter that is multiplied by ``drive_scale`` at each sample.
    ports : (SLOTS + 1, 3)
        States that are balance, position and velocity of each force (-1: there is none); the last
        row is the port whose position is returned.
    frames : (SLOTS + 1, 3)
        Rest position and scale of each port's motion, and the balance's change per unit of force.
    memory, q : (SLOTS, MEMORY), (SLOTS, parameters)
        Memory (changed in place) and parameters of each force.

    Returns
    -------
    (2, n)
        Output, and the normalised position, at each sample; NaN from where the states run away.
    """
    n, states = u.size, x0.size
    result = np.full((2, n), np.nan)
    x, stage = x0.copy(), np.empty(states)
    k1, k2, k3, k4 = np.empty(states), np.empty(states), np.empty(states), np.empty(states)
    p = p.copy()
    p_drive = p[drive]
    # Rows are cut out once: cutting them in the loop costs more than the forces do.
    memory_1, memory_2, memory_3 = memory[0], memory[1], memory[2]
    q_1, q_2, q_3 = q[0], q[1], q[2]
    pushes = np.zeros(SLOTS)
    h = interval / substeps
    z, z_next, travelled = np.zeros(SLOTS + 1), np.zeros(SLOTS + 1), np.zeros(SLOTS + 1)
    for i in range(n):
        p[drive] = p_drive * drive_scale[i]
        _positions(x, ports, frames, z)
        result[0, i] = output(x, u[i], p)
        result[1, i] = z[SLOTS]
        slope = (u[i + 1] - u[i]) / interval if linear_hold and i + 1 < n else 0.0
        for s in range(substeps):
            for order in range(4):
                k = k1 if order == 0 else k2 if order == 1 else k3 if order == 2 else k4
                ahead = 0.0 if order == 0 else h if order == 3 else 0.5 * h
                for j in range(states):
                    before = k1[j] if order == 1 else k2[j] if order == 2 else k3[j]
                    stage[j] = x[j] + (ahead * before if order else 0.0)
                derivative(stage, u[i] + slope * (s * h + ahead), p, k)
                for e in range(forces):
                    position, velocity = ports[e, 1], ports[e, 2]
                    rest, scale = frames[e, 0], frames[e, 1]
                    at = (stage[position] - rest) / scale if position >= 0 else z[e]
                    w = (stage[velocity] if velocity >= 0 else k[position]) / scale
                    if e == 0:
                        force = force_1(at, w, memory_1, q_1)
                    elif e == 1:
                        force = force_2(at, w, memory_2, q_2)
                    else:
                        force = force_3(at, w, memory_3, q_3)
                    pushes[e] = frames[e, 2] * force
                for e in range(forces):
                    k[ports[e, 0]] += pushes[e]
            for j in range(states):
                step = h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
                for e in range(forces):
                    if ports[e, 1] < 0 and ports[e, 2] == j:
                        travelled[e] += h * (x[j] + 0.5 * step) / frames[e, 1]
                x[j] += step
            if forces:
                _positions(x, ports, frames, z_next)
                for e in range(forces):
                    if ports[e, 1] < 0:
                        z_next[e] = travelled[e]
                update_1(z[0], z_next[0], h, memory_1, q_1)
                if forces > 1:
                    update_2(z[1], z_next[1], h, memory_2, q_2)
                if forces > 2:
                    update_3(z[2], z_next[2], h, memory_3, q_3)
                z[:] = z_next
        for j in range(states):
            if not abs(x[j]) < 1e12:
                return result
    return result
