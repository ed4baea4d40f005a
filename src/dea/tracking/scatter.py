"""How much more estimates of separate windows scatter than the noise within a window explains.

The noise within a window gives the covariance C_k of its estimate theta_k. Parameters that walk or
bend within a window, and a structure that lacks something, of which each window's input gives
another approximation, add to its error. Both are seen in the second differences d_k = theta_{k-1} -
2 theta_k + theta_{k+1} of windows that follow each other without common samples, in which a steady
drift cancels, and of which noise alone explains 6 C. The generalised eigenvalues of their second
moment and that covariance tell in which directions of the parameters they are larger: a walk of a
gain, for instance, which a window determines best, and not of a pole. The curvature's own bias,
theta'' L^2/24 = d/24, is a small part of this.

A ratio that a few windows show is itself uncertain: bands that hold for a known variance are then
wider by Student's quantile. A ratio that noise alone would show in one of twenty records is left as
it is, lest records in which nothing scatters pay for it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Array = NDArray[np.float64]

# Squared differences beyond so many medians count no more: those of windows in another minimum.
_LARGEST = 10.0
_LEVEL = 0.95


def widened(centre: Array, theta: Array, covariance: Array, length: int) -> Array:
    """Return the covariances (k, p, p) with the scatter, in no direction less than by the noise.

    Parameters
    ----------
    centre
        Centres of the windows in samples, ascending, shape (k,).
    theta, covariance
        Estimates (k, p) and their covariances (k, p, p) by the noise.
    length
        Samples of a window. Fewer than three separate windows tell nothing.
    """
    inside = (centre >= centre[0] + length) & (centre <= centre[-1] - length)
    # Rounding leaves directions that a window hardly determines without a variance.
    inside &= np.linalg.eigvalsh(covariance)[:, 0] > 0.0
    if not inside.any():
        return covariance
    before, after = (_interpolated(centre, theta, centre + step) for step in (-length, length))
    difference = (before - 2.0 * theta + after)[inside] / np.sqrt(6.0)
    root, inverse = _roots(covariance[inside].mean(axis=0))
    white = difference @ inverse.T
    squared = np.sum(white**2, axis=1)
    weight = np.minimum(1.0, _LARGEST * np.median(squared) / np.maximum(squared, 1e-300))
    value, direction = np.linalg.eigh((white * weight[:, None]).T @ white / len(white))
    value = _uncertain(value, _degrees_of_freedom(centre[inside] / length))
    stretch = (direction * np.sqrt(np.maximum(value, 1.0))) @ direction.T
    factor = root @ stretch @ inverse
    wider: Array = factor @ covariance @ factor.T
    return wider


def _degrees_of_freedom(centre: Array) -> float:
    """Return those of the mean of squared second differences at centres in lengths of a window.

    Estimates of windows are means of white noise; twice the squared mean over the variance.
    """

    def common(distance: Array) -> Array:
        part: Array = np.maximum(1.0 - np.abs(distance), 0.0)
        return part

    lag = np.subtract.outer(centre, centre)
    near, far = (common(lag - step) + common(lag + step) for step in (1.0, 2.0))
    correlation = (6.0 * common(lag) - 4.0 * near + far) / 6.0
    return float(centre.size**2 / np.sum(correlation**2))


def _uncertain(ratio: Array, freedom: float) -> Array:
    """Return ratios of variances such that a normal quantile of them is Student's of the ratios."""
    tail = 0.5 * (1.0 + _LEVEL)
    wider = float(stats.t.ppf(tail, freedom) / stats.norm.ppf(tail)) ** 2
    beyond_chance = ratio > stats.chi2.ppf(_LEVEL, freedom) / freedom
    return np.where(beyond_chance, wider * ratio, ratio)


def _roots(covariance: Array) -> tuple[Array, Array]:
    """Return R, with R R^T the covariance, and its inverse."""
    scale = np.sqrt(np.diag(covariance))
    value, direction = np.linalg.eigh(covariance / np.outer(scale, scale))
    deviation = np.sqrt(np.maximum(value, np.finfo(float).eps))
    return scale[:, None] * direction * deviation, (direction / deviation).T / scale


def _interpolated(centre: Array, theta: Array, t: Array) -> Array:
    """Return the estimates at other times, those of the ends beyond them."""
    return np.stack([np.interp(t, centre, column) for column in theta.T], axis=1)
