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
wider by Student's quantile. Ratios that noise alone exceeds in more than one of twenty records, the
largest of the directions, are left as they are, so that records in which nothing scatters keep
their bands.
"""

import numpy as np
from scipy.special import stdtrit

from dea.arrays import Array
from dea.narx import LEVEL, quantile

# Squared differences beyond so many medians count no more: those of windows in another minimum.
_LARGEST = 10.0
# Quantile of Tracy and Widom's first law that noise exceeds in one of twenty records.
_TRACY_WIDOM = 0.9793


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
    wider = float(stdtrit(freedom, 0.5 + 0.5 * LEVEL) / quantile(LEVEL)) ** 2
    return np.where(ratio > _by_chance(ratio.size, freedom), wider * ratio, ratio)


def _by_chance(directions: int, freedom: float) -> float:
    """Return what the largest of so many ratios of noise exceeds in one of twenty records.

    Johnstone (2001), Annals of Statistics 29:295: the largest eigenvalue of a Wishart matrix.
    """
    own, many = np.sqrt(max(freedom - 1.0, 0.5)), np.sqrt(directions)
    spread = (own + many) * (1.0 / own + 1.0 / many) ** (1.0 / 3.0)
    return float(((own + many) ** 2 + _TRACY_WIDOM * spread) / freedom)


def _roots(covariance: Array) -> tuple[Array, Array]:
    """Return R, with R R^T the covariance, and its inverse."""
    scale = np.sqrt(np.diag(covariance))
    value, direction = np.linalg.eigh(covariance / np.outer(scale, scale))
    deviation = np.sqrt(np.maximum(value, np.finfo(float).eps))
    return scale[:, None] * direction * deviation, (direction / deviation).T / scale


def _interpolated(centre: Array, theta: Array, t: Array) -> Array:
    """Return the estimates at other times, those of the ends beyond them."""
    return np.stack([np.interp(t, centre, column) for column in theta.T], axis=1)
