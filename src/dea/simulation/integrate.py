"""The integrator of every simulation with every force law."""

from functools import cache
from typing import Any

import numpy as np
from numba import njit, types

from dea.simulation.arguments import (
    ARGUMENTS,
    ARGUMENTS_OF_SEVERAL,
    Course,
    Equations,
    Forces,
    Reading,
    Values,
    Workspace,
)
from dea.simulation.cayley_hamilton import advance_four, advance_three, advance_two
from dea.simulation.exponential import advance
from dea.simulation.signatures import SLOTS, borrowed

DIVERGED = 1e30  # far above states in any unit, far below where their products overflow


@njit(inline="always")
def _positions(x: np.ndarray, ports: np.ndarray, normalisations: np.ndarray, z: np.ndarray) -> None:
    """Write the normalised position of each port that has one."""
    for e in range(SLOTS + 1):
        if ports[e, 1] >= 0:
            z[e] = (x[ports[e, 1]] - normalisations[e, 0]) / normalisations[e, 1]


@njit(inline="always")
def _travelled(
    x: np.ndarray,
    step: np.ndarray,
    h: float,
    ports: np.ndarray,
    normalisations: np.ndarray,
    z: np.ndarray,
    z_next: np.ndarray,
) -> None:
    """Write where each port that knows a velocity alone is after a ``step`` of the states ``x``."""
    for e in range(SLOTS + 1):
        velocity = ports[e, 2]
        if ports[e, 1] < 0 and velocity >= 0:
            z_next[e] = z[e] + h * (x[velocity] + 0.5 * step[velocity]) / normalisations[e, 1]


@njit(inline="always")
def _moving(attached: int, still: np.ndarray, lead: int) -> tuple[bool, bool, bool]:
    """Return which of the memories change, while ``lead`` samples are left until the record."""
    return (
        attached > 0 and not (lead and still[0]),
        attached > 1 and not (lead and still[1]),
        attached > 2 and not (lead and still[2]),
    )


@njit(inline="always")
def _with_rate(
    output: Any,
    x: np.ndarray,
    slope: np.ndarray,
    u: Any,
    p: np.ndarray,
    soon: float,
    moved: np.ndarray,
) -> tuple[float, float]:
    """Return the output and its rate per second where the states change by ``slope``."""
    now = output(x, u, p)
    for j in range(x.size):
        moved[j] = x[j] + soon * slope[j]
    return now, (output(moved, u, p) - now) / soon


@njit(types.void(*ARGUMENTS), cache=True, nogil=True)
def integrate(
    equations: Equations,
    values: Values,
    course: Course,
    forces: Forces,
    reading: Reading,
    workspace: Workspace,
) -> None:
    """Integrate by the exponential Rosenbrock-Euler method with steps of ``interval/substeps``.

    The method is exact for a linear simulation under an input that is held, or straight between
    samples, however stiff, and of second order otherwise (Hochbruck and Ostermann 2010, Acta
    Numerica 19:209, sections 2.4 and 3.4 with the change of the input over the step). Effects with
    memory are split off (Strang 1968): within a step the force is evaluated with the memory of
    the step's middle, which is then brought forward by the motion over the step.

    What it finds is written to ``workspace.result``.
    """
    derivative, output, law_1, law_2, law_3 = equations
    u, steps, straight, drive_scale, interval, substeps, lead = course
    attached, ports, normalisations, still, memory, q = forces
    taken_over, gains = reading
    result, vectors, matrices = workspace
    # The caller holds all arrays that reach the equations and the laws.
    u, steps, p = borrowed(u), borrowed(steps), borrowed(values.parameters)
    memory, q = borrowed(memory), borrowed(q)
    vectors, matrices = borrowed(vectors), borrowed(matrices)
    # Rows are sliced once: slicing them in the loop takes longer than the forces do.
    m1, m2, m3 = memory[0], memory[1], memory[2]
    q1, q2, q3 = q[0], q[1], q[2]
    x, moved, step, slope = vectors[0], vectors[1], vectors[2], vectors[3]
    beside, unforced, ramp, typical = vectors[4], vectors[5], vectors[6], vectors[7]
    J, room = matrices[0], matrices[1:]
    order = len(taken_over)
    read, filtered = np.zeros(order), np.empty(order)
    n, states = len(u), x.size
    drive = values.drive
    p_drive = p[drive]
    x[:] = values.initial
    typical[:] = np.abs(x) + 1e-6
    # Until there is a Jacobian, -inf gives every finite difference its smallest step.
    J[:] = -np.inf
    pushes = np.zeros(SLOTS)
    h = interval / substeps
    soon = 1e-3 * h  # over which the output's rate is a difference
    z, z_next = np.zeros(SLOTS + 1), np.zeros(SLOTS + 1)
    # Memories are kept half a step ahead, which makes the splitting one of second order.
    _positions(x, ports, normalisations, z)
    z_next[:] = z
    moves_1, moves_2, moves_3 = _moving(attached, still, lead)
    if moves_1:
        law_1.update(z[0], z[0], 0.5 * h, m1, q1)
    if moves_2:
        law_2.update(z[1], z[1], 0.5 * h, m2, q2)
    if moves_3:
        law_3.update(z[2], z[2], 0.5 * h, m3, q3)
    for i in range(n):
        p[drive] = p_drive * drive_scale[i]
        if i == lead:
            moves_1, moves_2, moves_3 = _moving(attached, still, 0)
        result[0, i] = output(x, u[i], p)
        if order:
            if not i:
                read[0] = result[0, 0]
            result[0, i] = read[0]
        result[1, i] = z[SLOTS]
        for s in range(substeps):
            v = steps[i * substeps + s]
            # Column 0 is the slope at x; column j that beside it in state j - 1.
            for column in range(states + 1):
                nudge = 0.0
                for j in range(states):
                    moved[j] = x[j]
                if column:
                    typical[column - 1] = max(typical[column - 1], abs(x[column - 1]))
                    nudge = 1e-6 * typical[column - 1]
                    if not i:  # a state that starts at zero shows its size by its slope alone
                        nudge = max(nudge, 1e-6 * h * abs(slope[column - 1]))
                    # Where a force looks at the position, the secant over the coming motion
                    # sees the corners of its law. What decays fast moves by less than h times
                    # its slope, as the Jacobian before tells. Of a port without a position the
                    # speed moves the middle of the step.
                    for e in range(attached):
                        looks = ports[e, 1] if ports[e, 1] >= 0 else ports[e, 2]
                        if looks == column - 1:
                            coming = h * slope[column - 1]
                            coming /= 1.0 + h * max(-J[column - 1, column - 1], 0.0)
                            if abs(coming) > nudge:
                                nudge = coming
                    moved[column - 1] += nudge
                derivative(moved, v, p, beside)
                if not column:
                    for j in range(states):
                        unforced[j] = beside[j]
                for e in range(attached):
                    position, velocity = ports[e, 1], ports[e, 2]
                    rest, scale = normalisations[e, 0], normalisations[e, 1]
                    w = (moved[velocity] if velocity >= 0 else beside[position]) / scale
                    at = (moved[position] - rest) / scale if position >= 0 else z[e] + 0.5 * h * w
                    if e == 0:
                        push = law_1.force(at, w, m1, q1)
                    elif e == 1:
                        push = law_2.force(at, w, m2, q2)
                    else:
                        push = law_3.force(at, w, m3, q3)
                    pushes[e] = normalisations[e, 2] * push
                for e in range(attached):
                    beside[ports[e, 0]] += pushes[e]
                    if ports[e, 3] >= 0:
                        beside[ports[e, 3]] -= pushes[e]
                for j in range(states):
                    if column:
                        J[j, column - 1] = (beside[j] - slope[j]) / nudge
                    else:
                        slope[j] = beside[j]
            if straight:
                derivative(x, steps[i * substeps + s + 1], p, beside)
                for j in range(states):
                    ramp[j] = beside[j] - unforced[j]
            advanced = False
            if states == 2:
                advanced = advance_two(J, slope, ramp, h, step)
            elif states == 3:
                advanced = advance_three(J, slope, ramp, h, step)
            elif states == 4:
                advanced = advance_four(J, slope, ramp, h, step)
            if not advanced:
                advance(J, slope, ramp, h, step, room)
            _travelled(x, step, h, ports, normalisations, z, z_next)
            if order:
                first, first_rate = _with_rate(output, x, slope, u[i], p, soon, moved)
                for j in range(states):
                    beside[j] = slope[j] + ramp[j]
                    for k in range(states):
                        beside[j] += J[j, k] * step[k]
            for j in range(states):
                x[j] += step[j]
            if order:
                last, last_rate = _with_rate(output, x, beside, u[i], p, soon, moved)
                for k in range(order):
                    filtered[k] = gains[0, k] * first + gains[1, k] * last
                    filtered[k] += h * (gains[2, k] * first_rate + gains[3, k] * last_rate)
                    for j in range(order):
                        filtered[k] += taken_over[k, j] * read[j]
                for k in range(order):
                    read[k] = filtered[k]
            _positions(x, ports, normalisations, z_next)
            if moves_1:
                law_1.update(z[0], z_next[0], h, m1, q1)
            if moves_2:
                law_2.update(z[1], z_next[1], h, m2, q2)
            if moves_3:
                law_3.update(z[2], z_next[2], h, m3, q3)
            z[:] = z_next
        for j in range(states):
            if not abs(x[j]) < DIVERGED:
                return


@cache
def integrate_several() -> Any:
    """Return ``integrate`` for several inputs, which is compiled when it is first asked for.

    A value of the input is then a row, and so is that of the factor on the drives.
    """
    return njit(types.void(*ARGUMENTS_OF_SEVERAL), cache=True, nogil=True)(integrate.py_func)
