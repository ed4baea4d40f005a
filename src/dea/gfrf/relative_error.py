"""The response of an error to several signals over that of the output, from spectra of a record."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array, Complex

_LONGEST = 4000  # samples of a segment, which overlap by half
_SEGMENTS = 8  # independent ones, at least: nine that overlap by half
_PER_REGRESSOR = 3  # independent segments that a record is divided into
# Segments that overlap by half are correlated, with Hann's window by 1/6: so many of them count as
# one independent one (P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70).
_ALIKE = 1.0 + 2.0 / 6.0**2
# Correlation of the power of lines that are one and two apart, with Hann's window.
SHARED = 4.0 / 9.0, 1.0 / 36.0
# Complex values beyond the regressors, below which the noise is too uncertain to be averaged.
_LEAST_FREE = 3.0
_RESOLVED = 2.0  # periods in a segment
_LEAST = 1e-12  # share of a regressor's largest line that is added to its power at every line
_UNKNOWN = 1e3  # relative error that counts where the output has no response of its own


class RelativeError(NamedTuple):
    """The relative error of what each regressor drives, at lines where the inputs hold power.

    Parameters
    ----------
    frequency : (lines,)
        In Hz.
    relative, variance : (regressors, lines)
        Its value, and its variance by noise.
    free
        Complex values that the noise was estimated with.
    told_apart
        Share of an input's power that the other regressors do not explain: the median of its lines,
        of the input with the least.
    """

    frequency: Array
    relative: Complex
    variance: Array
    free: float
    told_apart: float


def relative_error(
    regressors: Array,
    inputs: int,
    outputs: Array,
    error: Array,
    known: NDArray[np.bool_],
    sampling_rate: float,
    excited_above: float,
) -> RelativeError | None:
    """Return how far off the response to each regressor is, by least squares at each line.

    None if the record is too short: fewer than nine segments, which overlap by half, are without a
    missing sample, or no more than the regressors and three.

    Parameters
    ----------
    regressors : (regressors, samples)
        Of which the first so many are the ``inputs``.
    outputs, error, known : (samples,)
        Of which those that are ``known`` count.
    sampling_rate
        In Hz.
    excited_above
        Share of the largest power density of an input above which a frequency counts as excited.
    """
    shortest = max(_SEGMENTS, _PER_REGRESSOR * len(regressors))
    length = min(_LONGEST, error.size // shortest)
    if length < 4 * _RESOLVED:
        return None
    every = range(0, known.size - length + 1, length // 2)
    starts = np.array([a for a in every if known[a : a + length].all()], dtype=np.int64)
    averages = starts.size / _ALIKE
    free = averages - len(regressors)
    if averages < _SEGMENTS or free <= _LEAST_FREE:
        return None
    U, Y, E = (
        _transformed(each, starts, length) for each in (regressors, outputs[None], error[None])
    )
    auto = np.einsum("ikf,jkf->fij", U.conj(), U)
    power = np.einsum("fii->if", auto).real
    frequency = np.fft.rfftfreq(length, 1.0 / sampling_rate)
    largest = power.max(axis=1)
    usable = (power > excited_above * largest[:, None])[:inputs].all(axis=0)
    usable &= frequency >= _RESOLVED * sampling_rate / length
    if not usable.any():
        return None
    auto = auto[usable] + _LEAST * np.diag(largest)
    U, Y, E = U[..., usable], Y[0][:, usable], E[0][:, usable]
    to_error, to_output = (
        np.linalg.solve(auto, np.einsum("ikf,kf->fi", U.conj(), each)[..., None])[..., 0].T
        for each in (E, Y)
    )
    left = E - np.einsum("if,ikf->kf", to_error, U)
    noise = np.mean(np.abs(left) ** 2, axis=0) * averages / free
    spread = np.einsum("fii->if", np.linalg.inv(auto)).real
    response = _at_least(to_output, np.abs(to_error) / _UNKNOWN)
    return RelativeError(
        frequency[usable],
        np.asarray(to_error / response, dtype=np.complex128),
        _ALIKE * noise * spread / np.abs(response) ** 2,
        free,
        float(np.median(1.0 / (spread * power[:, usable])[:inputs], axis=1).min()),
    )


def _at_least(response: Complex, least: Array) -> Complex:
    """Return a response, the ``least`` magnitude where its own is smaller, one where both are 0."""
    found = np.where(np.abs(response) > least, response, least)
    return np.where(found == 0.0, 1.0, found)


def _transformed(signals: Array, starts: NDArray[np.int64], length: int) -> NDArray[np.complex128]:
    """Return the spectra (signals, segments, lines) of segments without their line in time."""
    from scipy.signal import detrend
    from scipy.signal.windows import hann

    cut = signals[:, starts[:, None] + np.arange(length)]
    found: NDArray[np.complex128] = np.fft.rfft(detrend(cut, axis=-1) * hann(length, sym=False))
    return found
