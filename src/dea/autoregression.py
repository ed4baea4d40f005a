"""Autoregressive models of noise: v_t = w_t - a_1 v_{t-1} - ... - a_p v_{t-p}, w white."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array

_HIGHEST = 20  # order
_SAMPLES_PER_ORDER = 20  # of the record, at least


class Autoregression(NamedTuple):
    """Coefficients (1, a_1, ..., a_p), variance of w, and the criterion of the choice of p.

    The criterion is Schwarz's over the number of samples.
    """

    coefficients: Array
    variance: float
    criterion: float

    @property
    def order(self) -> int:
        """p; zero is white noise."""
        return self.coefficients.size - 1


def fit_autoregression(segments: Sequence[Array]) -> Autoregression:
    """Fit one model to several segments of noise, each of shape (samples,); NaN is missing.

    Yule and Walker's equations are solved for each order by Levinson's recursion, which makes every
    model stable; the order has the least Bayesian information criterion (Schwarz 1978). The product
    at a lag is averaged over the pairs of samples that are there (E. Parzen, Sankhya A 25 (1963)),
    and no lag counts at which less than half of the samples have a partner. With more than a tenth
    missing, the order and the variance are those of noise that is easier to predict.
    """
    count = sum(int(np.isfinite(noise).sum()) for noise in segments)
    covariance = _covariance(segments, min(_HIGHEST, count // _SAMPLES_PER_ORDER), count)
    a, variance = np.ones(1), float(covariance[0])
    if variance == 0.0:
        return Autoregression(a, 0.0, -np.inf)
    best = Autoregression(a, variance, float(np.log(variance)))
    for order in range(1, covariance.size):
        reflection = -float(a @ covariance[order:0:-1]) / variance
        longer = np.append(a, 0.0)
        a = longer + reflection * longer[::-1]
        variance *= 1.0 - reflection**2
        if not variance > 0.0:
            break
        criterion = np.log(variance) + order * np.log(count) / count
        if criterion < best.criterion:
            best = Autoregression(a.copy(), float(variance), float(criterion))
    return best


def _covariance(segments: Sequence[Array], highest: int, count: int) -> Array:
    """Return the autocovariance of ``count`` samples at lags 0 to ``highest``, or to fewer.

    As if no sample were missing it falls with the lag, by the pairs that the ends leave out: it is
    then positive definite.
    """
    total = sum(noise.size for noise in segments)
    there = [np.isfinite(noise).astype(float) for noise in segments]
    known = [np.where(np.isfinite(noise), noise, 0.0) for noise in segments]
    covariance = np.zeros(highest + 1)
    for lag in range(highest + 1):
        pairs = sum(_product(each, lag) for each in there)
        if pairs < max(count / 2, 1):
            return covariance[: max(lag, 1)]
        whole = sum(max(noise.size - lag, 0) for noise in segments)
        products = sum(_product(noise, lag) / total for noise in known)
        covariance[lag] = products * (whole / pairs)
    return covariance


def _product(signal: Array, lag: int) -> float:
    return float(signal[lag:] @ signal[: max(signal.size - lag, 0)])


def whiten(noise: Autoregression, signal: Array) -> Array:
    """Return w of a signal (samples, ...): sum_k a_k signal[t - k], the past before it zero."""
    white = signal.copy()
    for lag, coefficient in enumerate(noise.coefficients[1:], start=1):
        white[lag:] += coefficient * signal[:-lag]
    return white


def innovations(noise: Autoregression, signal: Array) -> Array:
    """Return w of a signal (samples,) from the first complete past on, (samples - order,)."""
    left: Array = np.convolve(signal, noise.coefficients, "valid")
    return left


def noise_energy(noise: Autoregression, slope: Array) -> Array:
    """Return slope^T Omega slope, Omega the covariance matrix of the noise over the samples."""
    from scipy.signal import lfilter

    if noise.order:
        # Omega = A^-1 A^-T sigma^2 with A lower triangular: A^-T runs backwards in time.
        slope = lfilter([1.0], noise.coefficients, slope[::-1], axis=0)
    energy: Array = noise.variance * (slope.T @ slope)
    return energy
