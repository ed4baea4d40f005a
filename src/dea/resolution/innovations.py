"""Whiten signals of which some samples are missing, by the Kalman filter of their error."""

import numpy as np
from numba import njit


@njit(cache=True)
def innovation_variances(
    known: np.ndarray, white: float, coloured: np.ndarray, poles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the variance of each innovation (n,), and the gains (n, k) of the filter.

    The error is white noise of variance ``white`` beside independent autoregressions of first
    order with these ``poles`` (k,) and variances ``coloured`` (k,). The innovation is what a sample
    differs by from its prediction by the ``known`` ones (n, bool) before it; where a sample is not
    known, gains and variance are zero. B. D. O. Anderson and J. B. Moore, Optimal Filtering
    (1979), chapter 5.
    """
    n, k = known.size, poles.size
    P = np.diag(coloured)
    variances, gains = np.zeros(n), np.zeros((n, k))
    for t in range(n):
        if t:
            for i in range(k):
                for j in range(k):
                    P[i, j] *= poles[i] * poles[j]
                P[i, i] += (1.0 - poles[i] ** 2) * coloured[i]
        if known[t]:
            rows = np.zeros(k)
            for i in range(k):
                for j in range(k):
                    rows[i] += P[i, j]
            variances[t] = white + rows.sum()
            gains[t] = rows / variances[t]
            for i in range(k):
                for j in range(k):
                    P[i, j] -= gains[t, i] * rows[j]
    return variances, gains


@njit(cache=True)
def innovations(
    signals: np.ndarray, known: np.ndarray, gains: np.ndarray, poles: np.ndarray
) -> np.ndarray:
    """Return the innovations of signals (n, m) at the known samples, by the gains of the filter."""
    n, m = signals.shape
    states = np.zeros((poles.size, m))
    result = np.empty((np.count_nonzero(known), m))
    row = 0
    for t in range(n):
        for i in range(poles.size):
            for j in range(m):
                states[i, j] *= poles[i]
        if known[t]:
            for j in range(m):
                left = signals[t, j]
                for i in range(poles.size):
                    left -= states[i, j]
                result[row, j] = left
                for i in range(poles.size):
                    states[i, j] += gains[t, i] * left
            row += 1
    return result
