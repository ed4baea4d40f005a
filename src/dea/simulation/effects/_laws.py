"""Functions that several laws share."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numba import float64, njit

from dea.simulation.cubic import weights
from dea.simulation.signatures import VECTOR


@njit(float64(float64, float64), cache=True, error_model="numpy")
def knee(x: float, width: float) -> float:
    """Return max(x, 0) with a parabola of half-width ``width`` in place of the corner."""
    if x >= width:
        return x
    if x <= -width:
        return 0.0
    return (x + width) ** 2 / (4.0 * width)


# Sharpness from which four to its power is beyond the digits of a double: 4^27 = 2^54.
_SHARP = 27.0


@njit(float64(float64, float64, float64), cache=True, error_model="numpy")
def limited(x: float, limit: float, sharpness: float) -> float:
    """Return x / (1 + (x/limit)^p)^(1/p) for x > 0: soft at p = 1, a corner as p grows.

    A limit of zero lets nothing pass.
    """
    if x <= 0.0:
        return x
    if limit <= 0.0:
        return 0.0
    ratio = x / limit
    if sharpness >= _SHARP:
        # The power is below the last digit of one.
        if ratio < 0.25:
            return x
        if ratio > 4.0:
            return x / ratio
    largest = max(1.0, ratio)
    # Powers of numbers below one cannot overflow.
    result: float = x / (
        largest * (largest**-sharpness + (ratio / largest) ** sharpness) ** (1.0 / sharpness)
    )
    return result


@njit(inline="always")
def _intervals(
    v: float, target: float, tau: float, falling: float, growth: float, interval: float
) -> float:
    """Return an interval over the time constant that :func:`remaining` has."""
    ratio = interval / (tau * falling if target < v else tau)
    if growth != 0.0:
        ratio *= np.exp(-growth * v * v)
    return ratio


@njit(inline="always")
def remaining(
    v: float, target: float, tau: float, falling: float, growth: float, interval: float
) -> tuple[float, float]:
    """Return which part of the distance v - target a first-order lag has left over an interval.

    On average, and at its end. Its time constant is ``tau`` while it rises and ``falling`` times
    that while it falls, exactly; where it begins at v it is longer by a factor of
    exp(``growth`` v²).
    """
    ratio = _intervals(v, target, tau, falling, growth, interval)
    decay = np.exp(-ratio)
    return (1.0 - decay) / ratio if ratio > 1e-9 else 1.0, decay


@njit(inline="always")
def held_charge(
    v: float, target: float, tau: float, falling: float, growth: float, interval: float
) -> tuple[float, float]:
    """Return the mean and the end of a first-order lag that follows a held value for an interval.

    The time constants are those of :func:`remaining`.
    """
    mean, end = remaining(v, target, tau, falling, growth, interval)
    return target + (v - target) * mean, target + (v - target) * end


@njit(inline="always")
def time_at(slow: float, apart: float, full: float, order: float) -> float:
    """Return the time constant at a distance whose power ``order`` is the rate.

    At a distance of ``full`` it is ``slow``.
    """
    if order == 1.0 or apart == 0.0:
        return slow
    result: float = slow / (abs(apart) / full) ** (order - 1.0)
    return result


@njit(cache=True, error_model="numpy")
def powered(
    v: float, target: float, tau: float, falling: float, growth: float, interval: float,
    order: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the mean and the end of what follows a held value with a power of the distance.

    The distance x obeys dx/dt = -x^``order`` / tau in units of its first value, exactly, with an
    order of at least one. The time constants of the start are those of :func:`remaining`.
    """
    beyond = order - 1.0
    if beyond < 1e-6:
        return held_charge(v, target, tau, falling, growth, interval)
    ratio = _intervals(v, target, tau, falling, growth, interval)
    growing = np.log1p(beyond * ratio)
    if ratio < 1e-9:
        mean, end = 1.0, 1.0
    else:
        end = np.exp(-growing / beyond)
        if abs(beyond - 1.0) < 1e-6:
            mean = growing / ratio
        else:
            mean = np.expm1((1.0 - 1.0 / beyond) * growing) / ((beyond - 1.0) * ratio)
    return target + (v - target) * mean, target + (v - target) * end


@njit(VECTOR(VECTOR, float64, float64), cache=True, error_model="numpy")
def held_lag(u: np.ndarray, tau: float, interval: float) -> np.ndarray:
    """Return the mean over each interval of a held input behind a lag that has settled before."""
    result, v = np.empty(u.size), u[0]
    for k in range(u.size):
        result[k], v = held_charge(v, u[k], tau, 1.0, 0.0, interval)
    return result


@njit(VECTOR(VECTOR, float64, float64), cache=True, error_model="numpy")
def delayed(u: np.ndarray, delay: float, interval: float) -> np.ndarray:
    """Return a signal shifted by a delay, with a straight line between samples."""
    shift = delay / interval
    whole = int(np.floor(shift))
    part = shift - whole
    result = np.empty(u.size)
    for k in range(u.size):
        result[k] = (1.0 - part) * u[max(k - whole, 0)] + part * u[max(k - whole - 1, 0)]
    return result


@njit(VECTOR(VECTOR, float64, float64), cache=True, error_model="numpy")
def delayed_smoothly(u: np.ndarray, delay: float, interval: float) -> np.ndarray:
    """Return a signal shifted by a delay, with a cubic through four samples between samples.

    Straight lines lower high frequencies between samples, and not at them, so that an estimated
    delay would tend to a whole number of samples.
    """
    shift = delay / interval
    whole = int(np.floor(shift))
    later, here, before, earlier = weights(shift - whole + 1.0)
    result = np.empty(u.size)
    last = u.size - 1
    for k in range(u.size):
        at = k - whole
        result[k] = (
            later * u[min(max(at + 1, 0), last)]
            + here * u[max(at, 0)]
            + before * u[max(at - 1, 0)]
            + earlier * u[max(at - 2, 0)]
        )
    return result


def low_pass(y: np.ndarray, polynomial: Sequence[float]) -> np.ndarray:
    """Return a signal (n,) behind 1/(polynomial in s), s in units of the sampling rate, exactly.

    The polynomial ends with one. The signal is straight between samples, and at rest before the
    first.
    """
    from scipy.signal import lfilter

    numerator, denominator = _held_straight(polynomial)
    # At rest the output is the input: what the delays of the filter then hold.
    held = np.cumsum((numerator - denominator)[:0:-1])[::-1]
    smooth: np.ndarray = lfilter(numerator, denominator, y, zi=y[0] * held)[0]
    return smooth


def _held_straight(polynomial: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the filter of a low pass for a signal that is straight between samples.

    ``scipy.signal.cont2discrete`` finds the same coefficients in three times the time.
    """
    states, (level, slope) = low_pass_step(polynomial, 1)
    response, moved = [slope[0]], level + states @ slope - slope
    for _ in range(len(states)):
        response.append(moved[0])
        moved = states @ moved
    denominator = np.poly(states)
    return np.convolve(denominator, response)[: len(states) + 1], denominator


def low_pass_step(polynomial: Sequence[float], derivatives: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how the states (k,) of 1/(polynomial in s) change over a unit of time.

    They are the output and its derivatives. The first matrix, shape (k, k), takes them over without
    a signal; the rows of the second, shape (derivatives + 1, k), are what they gain from a signal
    of one, and from a first and each higher derivative of one.
    """
    from scipy.linalg import expm

    leading, *others = polynomial
    order, size = len(others), len(others) + derivatives + 1
    whole = np.zeros((size, size))
    whole[: order - 1, 1:order] = np.eye(order - 1)
    whole[order - 1, :order] = -np.array(others[::-1]) / leading
    whole[order - 1, order] = 1.0 / leading
    whole[order:-1, order + 1 :] = np.eye(derivatives)
    step = expm(whole)
    return step[:order, :order], step[:order, order:].T


@njit(float64(float64, VECTOR), cache=True, error_model="numpy")
def spline(place: float, weights: np.ndarray) -> float:
    """Return the uniform cubic B-spline with ``weights`` (k + 3,) at 0 <= ``place`` <= k."""
    first = min(int(place), weights.size - 4)
    right = place - first
    left = 1.0 - right
    found = weights[first] * left**3 + weights[first + 3] * right**3
    found += weights[first + 1] * (4.0 - 6.0 * right**2 + 3.0 * right**3)
    found += weights[first + 2] * (4.0 - 6.0 * left**2 + 3.0 * left**3)
    return float(found / 6.0)


@cache
def smooth_modes(pieces: int, bend: float, most: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights of a spline (pieces + 3, m) of each mode, the smoothest first.

    And the prior deviations (m,) of the modes: the weights' second difference deviates by ``bend``,
    and no mode by more than ``most``. The first mode is straight, and a constant is no mode
    (P-splines: Eilers and Marx 1996, Statistical Science 11:89).
    """
    size = pieces + 3
    slope, curvature = (np.diff(np.eye(size), degree, axis=0) for degree in (1, 2))
    precision = np.eye(size) / size + 1e-3 * slope.T @ slope + curvature.T @ curvature / bend**2
    eigenvalues, modes = np.linalg.eigh(precision)
    modes = np.sqrt(size) * modes * np.sign(modes[-1])
    deviations = np.minimum(1.0 / np.sqrt(size * eigenvalues[1:]), most)
    return np.ascontiguousarray(modes[:, 1:]), deviations


# Pieces of a drift, and the prior deviation of the second difference of its weights.
_PIECES, _BEND = 10, 0.06
DRIFT_MODES = _PIECES + 2


@njit(VECTOR(VECTOR, float64, VECTOR), cache=True, error_model="numpy")
def _course(t: np.ndarray, duration: float, weights: np.ndarray) -> np.ndarray:
    result = np.empty(t.size)
    for k in range(t.size):
        result[k] = spline(_PIECES * min(max(t[k] / duration, 0.0), 1.0), weights)
    return result


def drift(t: np.ndarray, duration: float, modes: np.ndarray) -> np.ndarray:
    """Return a smooth course over the record: a cubic spline, given by its modes.

    The prior of the modes is that of an integrated random walk, so that the course is interpolated
    where no sample tells it, and goes on straight at its ends.
    """
    result: np.ndarray = _course(t, duration, drift_modes()[0] @ modes)
    return result


def drift_starts(size: float, duration: float) -> tuple[tuple[float, ...], ...]:
    """Return slow courses of a ``size``: rises and falls, straight ones and bent ones.

    The law is linear in its modes, but what a start promises counts in its own direction alone.
    """
    return tuple(
        (*(sign * size * float(n == mode) for n in range(DRIFT_MODES)), duration)
        for mode in range(2)
        for sign in (1.0, -1.0)
    )


def drift_modes() -> tuple[np.ndarray, np.ndarray]:
    """Return the modes of a drift, and their prior deviations."""
    return smooth_modes(_PIECES, _BEND)
