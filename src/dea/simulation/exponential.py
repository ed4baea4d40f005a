"""The step of an exponential integrator: φ functions of a small matrix times vectors."""

import numpy as np
from numba import float64, njit, types

from dea.simulation.signatures import CUBE, MATRIX, VECTOR

ROOM = 6  # matrices that :func:`advance` works in


@njit(types.void(MATRIX, MATRIX, MATRIX), cache=True)
def _multiply(A: np.ndarray, B: np.ndarray, product: np.ndarray) -> None:
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += A[i, k] * B[k, j]
            product[i, j] = total


@njit(types.void(MATRIX, VECTOR, VECTOR, float64, VECTOR, CUBE), cache=True)
def advance(
    J: np.ndarray,
    slope: np.ndarray,
    ramp: np.ndarray,
    h: float,
    step: np.ndarray,
    room: np.ndarray,
) -> None:
    """Write h φ₁(h J) f + h φ₂(h J) Δf by Taylor series of a halved step, doubled back.

    Higham 2008, section 10.7.4. ``room`` (ROOM, states, states) is overwritten: to allocate the
    matrices here would take longer than the sums do.
    """
    n = slope.size
    size = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(h * J[i, j])
        size = max(size, row)
    doublings = 0
    while size > 0.5 and doublings < 60:
        size *= 0.5
        doublings += 1
    A, phi, phi_2 = room[0], room[1], room[2]
    term, product, exponential = room[3], room[4], room[5]
    scale = h * 0.5**doublings
    for i in range(n):
        for j in range(n):
            A[i, j] = J[i, j] * scale
            term[i, j] = phi[i, j] = 1.0 if i == j else 0.0
            phi_2[i, j] = 0.5 * phi[i, j]
    for k in range(2, 11):
        _multiply(term, A, product)
        for i in range(n):
            for j in range(n):
                term[i, j] = product[i, j] / k
                phi[i, j] += term[i, j]
                phi_2[i, j] += term[i, j] / (k + 1)
    _multiply(A, phi, exponential)
    for i in range(n):
        exponential[i, i] += 1.0
    for _ in range(doublings):
        # e^A + 1 times φ₁ is twice φ₁ of twice the step; φ₂ needs the square of φ₁.
        _multiply(phi, phi, product)
        for i in range(n):
            for j in range(n):
                phi_2[i, j] = 0.25 * (product[i, j] + 2.0 * phi_2[i, j])
                term[i, j] = exponential[i, j]
            term[i, i] += 1.0
        _multiply(term, phi, product)
        for i in range(n):
            for j in range(n):
                phi[i, j] = 0.5 * product[i, j]
                term[i, j] = exponential[i, j]
        _multiply(term, term, exponential)
    for i in range(n):
        step[i] = 0.0
        for j in range(n):
            step[i] += h * (phi[i, j] * slope[j] + phi_2[i, j] * ramp[j])
