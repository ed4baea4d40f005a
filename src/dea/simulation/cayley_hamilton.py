"""The step of an exponential integrator for two to four states.

By the theorem of Cayley and Hamilton every function of a matrix of n rows is a polynomial of degree
n - 1 in it (Moler and Van Loan 2003, SIAM Review 45:3, method 8). Its coefficients follow from
those of the characteristic polynomial, so that a Taylor series and its doublings take some products
of numbers and not of matrices. They lose digits where eigenvalues are far apart, up to the largest
norms at most seven of sixteen.
"""

from math import sqrt

import numpy as np
from numba import boolean, float64, njit

from dea.simulation.signatures import MATRIX, VECTOR

# Norms of h J up to which a step is made: of two states, and of more.
LARGEST_OF_TWO, LARGEST = 2000.0, 64.0
# Coefficients of the Taylor series of φ₂, and the norms below which their terms change nothing.
_TAYLOR = 1.0 / np.cumprod(np.arange(1.0, 20.0))[1:]
_REACH = (1e-17 / _TAYLOR) ** (1.0 / np.maximum(np.arange(_TAYLOR.size), 1))


@njit(cache=True, error_model="numpy")
def _halvings(size: float) -> int:
    """Return how often a matrix of norm ``size`` is halved for its Taylor series."""
    count = 0
    while size > 1.0:
        size *= 0.5
        count += 1
    return count


@njit(cache=True, error_model="numpy")
def _degree(size: float) -> int:
    """Return the degree of a Taylor series of φ₂ that is exact up to the norm ``size``."""
    degree = _TAYLOR.size - 1
    while degree > 1 and size < _REACH[degree]:
        degree -= 1
    return degree


@njit(cache=True, error_model="numpy")
def phi_2_of_two(t: float, d: float, size: float) -> tuple[float, float]:
    """Return x, y with φ₂(A) = x A + y for A² = t A - d, of norm ``size``.

    With φ₁ = 1 + A φ₂, which is squared, φ₂(2 A) = φ₂(A)/2 + φ₁(A)²/4.
    """
    halvings = _halvings(size)
    part = 0.5**halvings
    t, d = t * part, d * part**2
    x, y = 0.0, 0.0
    for j in range(_degree(size * part), -1, -1):
        x, y = y + t * x, _TAYLOR[j] - d * x
    for _ in range(halvings):
        a, b = y + t * x, 1.0 - d * x
        square = a * a
        x, y = 0.25 * x + 0.125 * a * (2.0 * b + t * a), 0.5 * y + 0.25 * (b * b - d * square)
        t, d = 2.0 * t, 4.0 * d
    return x, y


@njit(cache=True, error_model="numpy")
def phi_2_of_three(t: float, m: float, k: float, size: float) -> tuple[float, float, float]:
    """Return x, y, z with φ₂(A) = x A² + y A + z for A³ = t A² - m A + k."""
    halvings = _halvings(size)
    part = 0.5**halvings
    t, m, k = t * part, m * part**2, k * part**3
    x, y, z = 0.0, 0.0, 0.0
    for j in range(_degree(size * part), -1, -1):
        x, y, z = y + t * x, z - m * x, _TAYLOR[j] + k * x
    for _ in range(halvings):
        a, b, c = y + t * x, z - m * x, 1.0 + k * x
        fourth, third = a * a, 2.0 * a * b + t * a * a
        second = b * b + 2.0 * a * c - m * fourth + t * third
        first = 2.0 * b * c + k * fourth - m * third
        x, y = 0.125 * x + 0.0625 * second, 0.25 * y + 0.125 * first
        z = 0.5 * z + 0.25 * (c * c + k * third)
        t, m, k = 2.0 * t, 4.0 * m, 8.0 * k
    return x, y, z


@njit(cache=True, error_model="numpy")
def phi_2_of_four(
    t: float, m: float, k: float, d: float, size: float
) -> tuple[float, float, float, float]:
    """Return w, x, y, z with φ₂(A) = w A³ + x A² + y A + z for A⁴ = t A³ - m A² + k A - d."""
    halvings = _halvings(size)
    part = 0.5**halvings
    t, m, k, d = t * part, m * part**2, k * part**3, d * part**4
    w, x, y, z = 0.0, 0.0, 0.0, 0.0
    for j in range(_degree(size * part), -1, -1):
        w, x, y, z = x + t * w, y - m * w, z + k * w, _TAYLOR[j] - d * w
    for _ in range(halvings):
        a, b, c, e = x + t * w, y - m * w, z + k * w, 1.0 - d * w
        sixth = a * a
        fifth = 2.0 * a * b + t * sixth
        fourth = 2.0 * a * c + b * b - m * sixth + t * fifth
        third = 2.0 * (a * e + b * c) + k * sixth - m * fifth + t * fourth
        second = 2.0 * b * e + c * c - d * sixth + k * fifth - m * fourth
        first = 2.0 * c * e - d * fifth + k * fourth
        w, x = 0.0625 * w + 0.03125 * third, 0.125 * x + 0.0625 * second
        y, z = 0.25 * y + 0.125 * first, 0.5 * z + 0.25 * (e * e - d * fourth)
        t, m, k, d = 2.0 * t, 4.0 * m, 8.0 * k, 16.0 * d
    return w, x, y, z


@njit(boolean(MATRIX, VECTOR, VECTOR, float64, VECTOR), cache=True, error_model="numpy")
def advance_two(
    J: np.ndarray, slope: np.ndarray, ramp: np.ndarray, h: float, step: np.ndarray
) -> bool:
    """Write h φ₁(h J) f + h φ₂(h J) Δf = h f + h φ₂(h J) (h J f + Δf) for two states.

    Return False, with nothing written, where h J is too large.
    """
    a, b, c, d = h * J[0, 0], h * J[0, 1], h * J[1, 0], h * J[1, 1]
    # The norm where the states are in such units that b and c are alike.
    size = max(abs(a), abs(d)) + sqrt(abs(b * c))
    if not size < LARGEST_OF_TWO:
        return False
    x, y = phi_2_of_two(a + d, a * d - b * c, size)
    p = ramp[0] + a * slope[0] + b * slope[1]
    q = ramp[1] + c * slope[0] + d * slope[1]
    step[0] = h * (slope[0] + y * p + x * (a * p + b * q))
    step[1] = h * (slope[1] + y * q + x * (c * p + d * q))
    return True


@njit(boolean(MATRIX, VECTOR, VECTOR, float64, VECTOR), cache=True, error_model="numpy")
def advance_three(
    J: np.ndarray, slope: np.ndarray, ramp: np.ndarray, h: float, step: np.ndarray
) -> bool:
    """Do as :func:`advance_two` for three states."""
    a, b, c = h * J[0, 0], h * J[0, 1], h * J[0, 2]
    d, e, f = h * J[1, 0], h * J[1, 1], h * J[1, 2]
    g, i, j = h * J[2, 0], h * J[2, 1], h * J[2, 2]
    size = max(abs(a) + abs(b) + abs(c), abs(d) + abs(e) + abs(f), abs(g) + abs(i) + abs(j))
    if not size < LARGEST:
        return False
    minor_1, minor_2, minor_3 = e * j - f * i, a * j - c * g, a * e - b * d
    determinant = a * minor_1 - b * (d * j - f * g) + c * (d * i - e * g)
    x, y, z = phi_2_of_three(a + e + j, minor_1 + minor_2 + minor_3, determinant, size)
    u, v, w = slope[0], slope[1], slope[2]
    p = ramp[0] + a * u + b * v + c * w
    q = ramp[1] + d * u + e * v + f * w
    r = ramp[2] + g * u + i * v + j * w
    u, v, w = x * p, x * q, x * r
    for share in (y, z):
        u, v, w = (
            share * p + a * u + b * v + c * w,
            share * q + d * u + e * v + f * w,
            share * r + g * u + i * v + j * w,
        )
    step[0], step[1], step[2] = h * (slope[0] + u), h * (slope[1] + v), h * (slope[2] + w)
    return True


@njit(boolean(MATRIX, VECTOR, VECTOR, float64, VECTOR), cache=True, error_model="numpy")
def advance_four(
    J: np.ndarray, slope: np.ndarray, ramp: np.ndarray, h: float, step: np.ndarray
) -> bool:
    """Do as :func:`advance_two` for four states.

    The determinant is expanded in minors of the upper and of the lower two rows (Laplace). Letters
    up to q are the rows of h J; r, s, t, y are those of h J f + Δf, and u, v, w, x of what is
    summed up from it.
    """
    a, b, c, d = h * J[0, 0], h * J[0, 1], h * J[0, 2], h * J[0, 3]
    e, f, g, i = h * J[1, 0], h * J[1, 1], h * J[1, 2], h * J[1, 3]
    j, k, l, m = h * J[2, 0], h * J[2, 1], h * J[2, 2], h * J[2, 3]  # noqa: E741
    n, o, p, q = h * J[3, 0], h * J[3, 1], h * J[3, 2], h * J[3, 3]
    size = max(abs(a) + abs(b) + abs(c) + abs(d), abs(e) + abs(f) + abs(g) + abs(i))
    size = max(size, abs(j) + abs(k) + abs(l) + abs(m), abs(n) + abs(o) + abs(p) + abs(q))
    if not size < LARGEST:
        return False
    upper_01, upper_02, upper_03 = a * f - b * e, a * g - c * e, a * i - d * e
    upper_12, upper_13, upper_23 = b * g - c * f, b * i - d * f, c * i - d * g
    lower_01, lower_02, lower_03 = j * o - k * n, j * p - l * n, j * q - m * n
    lower_12, lower_13, lower_23 = k * p - l * o, k * q - m * o, l * q - m * p
    pairs = upper_01 + lower_23 + (a * l - c * j) + (a * q - d * n) + (f * l - g * k)
    pairs += f * q - i * o
    triples = upper_01 * l - upper_02 * k + upper_12 * j
    triples += upper_01 * q - upper_03 * o + upper_13 * n
    triples += a * lower_23 - c * lower_03 + d * lower_02
    triples += f * lower_23 - g * lower_13 + i * lower_12
    determinant = upper_01 * lower_23 - upper_02 * lower_13 + upper_03 * lower_12
    determinant += upper_12 * lower_03 - upper_13 * lower_02 + upper_23 * lower_01
    third, second, first, zeroth = phi_2_of_four(a + f + l + q, pairs, triples, determinant, size)
    u, v, w, x = slope[0], slope[1], slope[2], slope[3]
    r = ramp[0] + a * u + b * v + c * w + d * x
    s = ramp[1] + e * u + f * v + g * w + i * x
    t = ramp[2] + j * u + k * v + l * w + m * x
    y = ramp[3] + n * u + o * v + p * w + q * x
    u, v, w, x = third * r, third * s, third * t, third * y
    for share in (second, first, zeroth):
        u, v, w, x = (
            share * r + a * u + b * v + c * w + d * x,
            share * s + e * u + f * v + g * w + i * x,
            share * t + j * u + k * v + l * w + m * x,
            share * y + n * u + o * v + p * w + q * x,
        )
    step[0], step[1] = h * (slope[0] + u), h * (slope[1] + v)
    step[2], step[3] = h * (slope[2] + w), h * (slope[3] + x)
    return True
