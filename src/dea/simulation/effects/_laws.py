"""Functions that several laws share."""

from collections.abc import Sequence

import numpy as np
from numba import float64, njit, types

_VECTOR = types.Array(float64, 1, "C")


@njit(float64(float64, float64), cache=True, error_model="numpy")
def knee(x: float, width: float) -> float:
    """Return max(x, 0) with a parabola of half-width ``width`` in place of the corner."""
    if x >= width:
        return x
    if x <= -width:
        return 0.0
    return (x + width) ** 2 / (4.0 * width)


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
    largest = max(1.0, ratio)
    # Powers of numbers below one cannot overflow.
    result: float = x / (
        largest * (largest**-sharpness + (ratio / largest) ** sharpness) ** (1.0 / sharpness)
    )
    return result


@njit(_VECTOR(_VECTOR, float64, float64, float64), cache=True, error_model="numpy")
def held_lag(u: np.ndarray, start: float, tau: float, interval: float) -> np.ndarray:
    """Return the mean over each interval of a held input behind a first-order lag, exactly.

    The lag stands at ``start`` when the record begins.
    """
    ratio = interval / tau
    decay = np.exp(-ratio)
    mean_weight = (1.0 - decay) / ratio if ratio > 1e-9 else 1.0
    result = np.empty(u.size)
    v = start
    for k in range(u.size):
        result[k] = u[k] + (v - u[k]) * mean_weight
        v = u[k] + (v - u[k]) * decay
    return result


@njit(_VECTOR(_VECTOR, float64, float64), cache=True, error_model="numpy")
def delayed(u: np.ndarray, delay: float, interval: float) -> np.ndarray:
    """Return a signal shifted by a delay, with a straight line between samples."""
    shift = delay / interval
    whole = int(np.floor(shift))
    part = shift - whole
    result = np.empty(u.size)
    for k in range(u.size):
        result[k] = (1.0 - part) * u[max(k - whole, 0)] + part * u[max(k - whole - 1, 0)]
    return result


def low_pass(y: np.ndarray, polynomial: Sequence[float]) -> np.ndarray:
    """Return a signal (n,) behind 1/(polynomial in s), s in units of the sampling rate, exactly.

    The signal is straight between samples, and at rest before the first.
    """
    from scipy.signal import cont2discrete, lfilter, lfilter_zi

    numerator, denominator, _ = cont2discrete(([1.0], polynomial), 1.0, method="foh")
    weights = numerator.ravel()
    smooth: np.ndarray = lfilter(
        weights, denominator, y, zi=y[0] * lfilter_zi(weights, denominator)
    )[0]
    return smooth


DRIFT_DEGREES = 8


def drift(t: np.ndarray, duration: float, weights: np.ndarray) -> np.ndarray:
    """Return the sum of Legendre polynomials of degree 1, 2, ... in time over the record."""
    x = 2.0 * t / duration - 1.0
    found: np.ndarray = np.polynomial.legendre.legval(x, np.concatenate([[0.0], weights]))
    return found
