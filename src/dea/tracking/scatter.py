"""How much more estimates of separate windows scatter than the noise within a window explains.

The noise within a window gives the covariance C_k of its estimate theta_k. Parameters that walk or
bend within a window, and a structure that lacks something, of which each window's input gives
another approximation, add to its error. Both are seen in the second differences d_k = theta_{k-1} -
2 theta_k + theta_{k+1} of windows that follow each other without common samples, in which a steady
drift cancels. They are weighed as the output sees them, by the energy d^T G d that they give the
free run, of which noise alone explains tr G (C_{k-1} + 4 C_k + C_{k+1}): directions that the record
hardly determines, along which no linearisation holds, hardly count. The curvature's own bias,
theta'' L^2/24 = d/24, is a small part of this.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def scatter(centre: Array, theta: Array, covariance: Array, energy: Array, length: int) -> float:
    """Return the factor on the covariances, 1 or more: the median over the record.

    Parameters
    ----------
    centre
        Centres of the windows in samples, ascending, shape (k,).
    theta, covariance
        Estimates (k, p) and their covariances (k, p, p) by the noise.
    energy
        G, of the derivative of each window's free run, (k, p, p).
    length
        Samples of a window. Fewer than three separate windows tell nothing.
    """
    inside = np.flatnonzero((centre >= centre[0] + length) & (centre <= centre[-1] - length))
    if not inside.size:
        return 1.0
    before, after = (_interpolated(centre, theta, centre + step) for step in (-length, length))
    difference = (before - 2.0 * theta + after)[inside]
    G = energy[inside]
    seen = np.einsum("ki,kij,kj->k", difference, G, difference)
    explained = 6.0 * np.einsum("kij,kji->k", G, covariance[inside])
    return max(1.0, float(np.median(seen / explained)))


def _interpolated(centre: Array, theta: Array, t: Array) -> Array:
    """Return the estimates at other times, those of the ends beyond them."""
    return np.stack([np.interp(t, centre, column) for column in theta.T], axis=1)
