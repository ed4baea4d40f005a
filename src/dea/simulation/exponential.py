"""The step of an exponential integrator: φ functions of a small matrix times vectors."""

import numpy as np
from numba import boolean, float64, njit, types

from dea.simulation.signatures import CUBE, MATRIX, VECTOR

ROOM = 6  # matrices that :func:`advance` works in
# Norm up to which a Taylor series serves :func:`advance_three`, and parts of a step at most.
LARGEST, MOST_PARTS = 3.0, 16


@njit(types.void(MATRIX, VECTOR, VECTOR, float64, VECTOR), cache=True)
def advance_two(
    J: np.ndarray, slope: np.ndarray, ramp: np.ndarray, h: float, step: np.ndarray
) -> None:
    """Write h φ₁(h J) f + h φ₂(h J) Δf for two states, interpolated at the eigenvalues of h J."""
    a, b, c, d = h * J[0, 0], h * J[0, 1], h * J[1, 0], h * J[1, 1]
    middle = 0.5 * (a + d)
    square = 0.25 * (a - d) ** 2 + b * c
    apart = max(np.sqrt(abs(square)), 1e-4)
    if square >= 0.0:
        first, second = middle + apart, middle - apart
        f1 = np.expm1(first) / first if abs(first) > 1e-8 else 1.0
        f2 = np.expm1(second) / second if abs(second) > 1e-8 else 1.0
        g1 = (f1 - 1.0) / first if abs(first) > 1e-4 else 0.5 + first / 6.0
        g2 = (f2 - 1.0) / second if abs(second) > 1e-4 else 0.5 + second / 6.0
        slope_1, slope_2 = (f1 - f2) / (2.0 * apart), (g1 - g2) / (2.0 * apart)
        constant_1, constant_2 = f1 - slope_1 * first, g1 - slope_2 * first
    else:
        # φ₁ and φ₂ at the complex pair middle ± i apart, in real and imaginary parts.
        growth, radius = np.exp(middle), middle * middle + apart * apart
        real, imaginary = growth * np.cos(apart) - 1.0, growth * np.sin(apart)
        real_1 = (real * middle + imaginary * apart) / radius
        imaginary_1 = (imaginary * middle - real * apart) / radius
        real_2 = ((real_1 - 1.0) * middle + imaginary_1 * apart) / radius
        imaginary_2 = (imaginary_1 * middle - (real_1 - 1.0) * apart) / radius
        slope_1, slope_2 = imaginary_1 / apart, imaginary_2 / apart
        constant_1, constant_2 = real_1 - slope_1 * middle, real_2 - slope_2 * middle
    f, g, up, to = slope[0], slope[1], ramp[0], ramp[1]
    step[0] = h * (constant_1 * f + slope_1 * (a * f + b * g))
    step[1] = h * (constant_1 * g + slope_1 * (c * f + d * g))
    step[0] += h * (constant_2 * up + slope_2 * (a * up + b * to))
    step[1] += h * (constant_2 * to + slope_2 * (c * up + d * to))


@njit(boolean(MATRIX, VECTOR, VECTOR, float64, VECTOR), cache=True)
def advance_three(
    J: np.ndarray, slope: np.ndarray, ramp: np.ndarray, h: float, step: np.ndarray
) -> bool:
    """Write h φ₁(h J) f + h φ₂(h J) Δf for three states.

    Return False, with nothing written, where h J is so large that :func:`advance` is faster.
    It is the solution of w' = J w + f + Δf t/h from w = 0, in equal parts of the step, each by a
    Taylor series of matrix times vector (Al-Mohy and Higham 2011, SIAM Journal on Scientific
    Computing 33:488).
    """
    a, b, c = h * J[0, 0], h * J[0, 1], h * J[0, 2]
    d, e, f = h * J[1, 0], h * J[1, 1], h * J[1, 2]
    g, i, j = h * J[2, 0], h * J[2, 1], h * J[2, 2]
    size = max(abs(a) + abs(b) + abs(c), abs(d) + abs(e) + abs(f), abs(g) + abs(i) + abs(j))
    if not size < LARGEST * MOST_PARTS:
        return False
    parts = int(size / LARGEST) + 1
    part, size = 1.0 / parts, size / parts
    terms, bound = 1, 0.5 * size
    while bound > 1e-16:
        terms += 1
        bound *= size / (terms + 1)
    x, y, z = 0.0, 0.0, 0.0
    up, to, at = h * ramp[0] * part, h * ramp[1] * part, h * ramp[2] * part
    for k in range(parts):
        p = h * slope[0] + k * up + a * x + b * y + c * z
        q = h * slope[1] + k * to + d * x + e * y + f * z
        r = h * slope[2] + k * at + g * x + i * y + j * z
        share = 1.0 / (terms + 2)
        u, v, w = p + share * up, q + share * to, r + share * at
        for term in range(terms + 1, 1, -1):
            share = 1.0 / term
            scale = part * share
            u, v, w = (
                p + share * up + scale * (a * u + b * v + c * w),
                q + share * to + scale * (d * u + e * v + f * w),
                r + share * at + scale * (g * u + i * v + j * w),
            )
        x, y, z = x + part * u, y + part * v, z + part * w
    step[0], step[1], step[2] = x, y, z
    return True


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
