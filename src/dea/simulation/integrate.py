"""The integrator of every simulation with every force law."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import float64, int64, njit, types

from dea.simulation.exponential import advance, advance_two
from dea.simulation.signatures import (
    DERIVATIVE,
    FORCE,
    INDEX,
    MATRIX,
    OUTPUT,
    SLOTS,
    UPDATE,
    VECTOR,
)


@njit(inline="always")
def _positions(x: np.ndarray, ports: np.ndarray, frames: np.ndarray, z: np.ndarray) -> None:
    """Write the normalised position of each port that has one."""
    for e in range(SLOTS + 1):
        if ports[e, 1] >= 0:
            z[e] = (x[ports[e, 1]] - frames[e, 0]) / frames[e, 1]


Law = Callable[..., Any]
_F, _U = types.FunctionType(FORCE), types.FunctionType(UPDATE)


@njit(
    MATRIX(
        types.FunctionType(DERIVATIVE), types.FunctionType(OUTPUT), _F, _U, _F, _U, _F, _U, int64,
        VECTOR, VECTOR, int64, VECTOR, int64, VECTOR, VECTOR, float64, int64,
        INDEX, MATRIX, MATRIX, MATRIX,
    ),
    cache=True,
    nogil=True,
)  # fmt: skip
def integrate(
    derivative: Law,
    output: Law,
    force_1: Law,
    update_1: Law,
    force_2: Law,
    update_2: Law,
    force_3: Law,
    update_3: Law,
    forces: int,
    u: np.ndarray,
    course: np.ndarray,
    straight: int,
    p: np.ndarray,
    drive: int,
    drive_scale: np.ndarray,
    x0: np.ndarray,
    interval: float,
    substeps: int,
    ports: np.ndarray,
    frames: np.ndarray,
    memory: np.ndarray,
    q: np.ndarray,
) -> np.ndarray:
    """Integrate by the exponential Rosenbrock-Euler method with steps of ``interval/substeps``.

    The method is exact for a linear simulation under an input that is held, or straight between
    samples, however stiff, and of second order otherwise (Hochbruck and Ostermann 2010, Acta
    Numerica 19:209, sections 2.4 and 3.4 with the change of the input over the step). Effects with
    memory are split off (Strang 1968): within a step the force is evaluated with the memory of
    the step's middle, which is then brought forward by the motion over the step.

    Parameters
    ----------
    u : (n,)
        Input at each sample, which the output may depend on.
    course : (n substeps + 1,)
        Input at the start of each step and at the end of the last; held over a step, or
        ``straight`` from one to the next.
    drive, drive_scale : int, (n,)
        Index of the parameter that is multiplied by ``drive_scale`` at each sample.
    ports : (SLOTS + 1, 4)
        States that are equation, position, velocity and reaction of each force (-1: there is
        none); the last row is the port whose position is returned.
    frames : (SLOTS + 1, 3)
        Rest position and scale of each port's motion, and the change of its equation per unit of
        force.
    memory, q : (SLOTS, MEMORY), (SLOTS, parameters)
        Memory (changed in place) and parameters of each force.

    Returns
    -------
    (2, n)
        Output, and the normalised position, at each sample; NaN from where the states diverge.
    """
    n, states = u.size, x0.size
    result = np.full((2, n), np.nan)
    x, moved, step = x0.copy(), np.empty(states), np.empty(states)
    slope, beside, ramp = np.empty(states), np.empty(states), np.zeros(states)
    pushes, J = np.zeros(SLOTS), np.empty((states, states))
    typical = np.abs(x0) + 1e-6
    p = p.copy()
    p_drive = p[drive]
    # Rows are sliced once: slicing them in the loop takes longer than the forces do.
    m1, m2, m3 = memory[0], memory[1], memory[2]
    q1, q2, q3 = q[0], q[1], q[2]
    h = interval / substeps
    z, z_next = np.zeros(SLOTS + 1), np.zeros(SLOTS + 1)
    # Memories are kept half a step ahead, which makes the splitting one of second order.
    _positions(x, ports, frames, z)
    if forces:
        update_1(z[0], z[0], 0.5 * h, m1, q1)
        if forces > 1:
            update_2(z[1], z[1], 0.5 * h, m2, q2)
        if forces > 2:
            update_3(z[2], z[2], 0.5 * h, m3, q3)
    for i in range(n):
        p[drive] = p_drive * drive_scale[i]
        _positions(x, ports, frames, z)
        result[0, i] = output(x, u[i], p)
        result[1, i] = z[SLOTS]
        for s in range(substeps):
            v = course[i * substeps + s]
            # Column 0 is the slope at x; column j that beside it in state j - 1.
            for column in range(states + 1):
                nudge = 0.0
                for j in range(states):
                    moved[j] = x[j]
                if column:
                    typical[column - 1] = max(typical[column - 1], abs(x[column - 1]))
                    nudge = 1e-6 * typical[column - 1]
                    # Where a force looks at the position, the secant over the coming motion
                    # sees the corners of its law.
                    for e in range(forces):
                        if ports[e, 1] == column - 1 and abs(h * slope[column - 1]) > nudge:
                            nudge = h * slope[column - 1]
                    moved[column - 1] += nudge
                derivative(moved, v, p, beside)
                for e in range(forces):
                    position, velocity = ports[e, 1], ports[e, 2]
                    rest, scale = frames[e, 0], frames[e, 1]
                    at = (moved[position] - rest) / scale if position >= 0 else z[e]
                    w = (moved[velocity] if velocity >= 0 else beside[position]) / scale
                    if e == 0:
                        push = force_1(at, w, m1, q1)
                    elif e == 1:
                        push = force_2(at, w, m2, q2)
                    else:
                        push = force_3(at, w, m3, q3)
                    pushes[e] = frames[e, 2] * push
                for e in range(forces):
                    beside[ports[e, 0]] += pushes[e]
                    if ports[e, 3] >= 0:
                        beside[ports[e, 3]] -= pushes[e]
                for j in range(states):
                    if column:
                        J[j, column - 1] = (beside[j] - slope[j]) / nudge
                    else:
                        slope[j] = beside[j]
            if straight:
                derivative(x, v, p, moved)
                derivative(x, course[i * substeps + s + 1], p, beside)
                for j in range(states):
                    ramp[j] = beside[j] - moved[j]
            if states == 2:
                advance_two(J, slope, ramp, h, step)
            else:
                advance(J, slope, ramp, h, step)
            for e in range(forces):
                if ports[e, 1] < 0:
                    z_next[e] = z[e] + h * (x[ports[e, 2]] + 0.5 * step[ports[e, 2]]) / frames[e, 1]
            for j in range(states):
                x[j] += step[j]
            if forces:
                _positions(x, ports, frames, z_next)
                update_1(z[0], z_next[0], h, m1, q1)
                if forces > 1:
                    update_2(z[1], z_next[1], h, m2, q2)
                if forces > 2:
                    update_3(z[2], z_next[2], h, m3, q3)
                for e in range(SLOTS):
                    z[e] = z_next[e]
        for j in range(states):
            if not abs(x[j]) < 1e12:
                return result
    return result
