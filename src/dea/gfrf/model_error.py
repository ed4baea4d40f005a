"""What a model's structure lacks, as its response: the model error model.

The error of a free run whose parameters follow the record holds what the terms cannot describe: a
creep slower than their lags, for instance. The best linear approximation from the input to that
error, over that to the output, is how far the gain is off and the phase (L. Ljung, Automatica 35,
1999, 403). It is measured with the record's own excitation, so that it tells how large the error of
a response is, and not what the response around one operating point should be.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array, Complex
from dea.inputs import by_input
from dea.missing import filled
from dea.narx import NarxModel, as_input, simulate_varying

_LONGEST = 4000  # samples of a segment, which overlap by half
_SEGMENTS = 8  # independent ones, at least: nine that overlap by half
# Segments that overlap by half are correlated, with Hann's window by 1/6: so many of them count as
# one independent one (P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70).
_ALIKE = 1.0 + 2.0 / 6.0**2
_CHANCE = 0.01  # with which noise alone is taken for an error, at a frequency and around it
# Deviation of the logarithm of the frequency over which neighbours count, and the correlation of
# the power of lines that are one and two apart, with Hann's window.
_LEAST_FREE = (
    3.0  # complex values, below which the noise is too uncertain to be averaged over lines
)
_AROUND, _SHARED = 0.5, (4.0 / 9.0, 1.0 / 36.0)
_RESOLVED = 2.0  # periods in a segment


@dataclass(frozen=True)
class ModelErrorModel:
    """Standard deviation of relative gain and of phase (rad) by input and frequency in Hz.

    Parameters
    ----------
    frequency : (lines,)
    gain, phase : (inputs, lines)
    """

    frequency: Array
    gain: Array
    phase: Array

    def at(self, frequency: Array, number: int = 1) -> tuple[Array, Array]:
        """Return gain and phase of an input at other frequencies; beyond the lines, the nearest."""
        gain, phase = (
            np.interp(frequency, self.frequency, each[number - 1])
            for each in (self.gain, self.phase)
        )
        return gain, phase


def model_error(
    model: NarxModel,
    parameters: Array,
    u: ArrayLike,
    y: ArrayLike,
    sampling_rate: float,
    excited_above: float,
) -> ModelErrorModel | None:
    """Return what the model lacks, or None where the record does not tell.

    It does not where the free run diverges or the record is too short.

    Parameters
    ----------
    model, parameters
        With parameters (samples, terms) that follow the record.
    u, y
        The record in physical units, (samples,) or (samples, inputs); missing outputs are NaN.
    excited_above
        Share of the largest power density of an input above which a frequency counts as excited.
    """
    scaling, signals = model.scaling, as_input(u)
    outputs, seen = filled(np.asarray(y, dtype=float))
    run = simulate_varying(
        model.terms, parameters, scaling.normalise_input(signals), scaling.normalise_output(outputs)
    )
    error = outputs - scaling.restore_output(run)
    length = min(_LONGEST, error.size // _SEGMENTS)
    if length < 4 * _RESOLVED:
        return None
    known = seen & np.isfinite(error)
    every = range(0, known.size - length + 1, length // 2)
    starts = np.array([a for a in every if known[a : a + length].all()], dtype=np.int64)
    averages = starts.size / _ALIKE
    if averages < _SEGMENTS:
        return None
    inputs = by_input(signals)
    U, Y, E = (_transformed(each, starts, length) for each in (inputs, outputs[None], error[None]))
    auto = np.einsum("ikf,jkf->fij", U.conj(), U)
    power = np.einsum("fii->if", auto).real
    frequency = np.fft.rfftfreq(length, 1.0 / sampling_rate)
    usable = (power > excited_above * power.max(axis=1, keepdims=True)).all(axis=0)
    usable &= frequency >= _RESOLVED * sampling_rate / length
    if not usable.any():
        return None
    auto, U, Y, E = auto[usable], U[..., usable], Y[0][:, usable], E[0][:, usable]
    to_error, to_output = (
        np.linalg.solve(auto, np.einsum("ikf,kf->fi", U.conj(), each)[..., None])[..., 0].T
        for each in (E, Y)
    )
    left = E - np.einsum("if,ikf->kf", to_error, U)
    noise = np.mean(np.abs(left) ** 2, axis=0) * averages / (averages - len(inputs))
    variance = _ALIKE * noise * np.einsum("fii->if", np.linalg.inv(auto)).real
    lines = frequency[usable]
    relative: Complex = np.asarray(to_error / to_output, dtype=np.complex128)
    variance /= np.abs(to_output) ** 2
    free = averages - len(inputs)
    return ModelErrorModel(lines, *_deviations(lines, relative, variance, free))


def _deviations(
    frequency: Array, relative: Complex, variance: Array, free: float
) -> tuple[Array, Array]:
    """Return the standard deviations of gain and phase (inputs, lines) of a relative error.

    It counts at a line where it is beyond chance there, and its mean around a line where that is:
    an error that the noise hides at one line is about as large as at its neighbours. The larger of
    the two counts, of gain and phase each. ``variance`` (inputs, lines) is that of the relative
    error by noise, estimated with so many ``free`` complex values.
    """
    from scipy.stats import gamma

    weights = np.exp(-0.5 * (np.log(frequency[:, None] / frequency) / _AROUND) ** 2)
    weights /= weights.sum(axis=1, keepdims=True)
    excess = [part**2 - 0.5 * variance for part in (relative.real, relative.imag)]
    power = np.abs(relative) ** 2
    here = power > -np.log(_CHANCE) * variance
    # The power of noise over its estimated mean is an F variable of 2 and 2 free degrees: of mean
    # free/(free - 1), and over that of variance free/(free - 2). A mean of lines is nearly a gamma
    # variable of its variance.
    around = np.zeros(power.shape, bool)
    if free > _LEAST_FREE:
        ratio = np.divide(power, variance, out=np.zeros_like(power), where=variance > 0.0)
        shape = (1.0 - 2.0 / free) / _spread(weights)
        limit = gamma.ppf(1.0 - _CHANCE, shape) / shape
        around = (1.0 - 1.0 / free) * ratio @ weights.T > limit
    gain, phase = (
        np.sqrt(np.maximum(np.maximum(each, 0.0) * here, (each @ weights.T) * around))
        for each in excess
    )
    return gain, phase


def _spread(weights: Array) -> Array:
    """Return the variance (lines,) of weighted means of lines, over that of one line."""
    spread: Array = np.sum(weights**2, axis=1)
    for apart, shared in enumerate(_SHARED, 1):
        spread += 2.0 * shared * np.sum(weights[:, apart:] * weights[:, :-apart], axis=1)
    return spread


def _transformed(signals: Array, starts: NDArray[np.int64], length: int) -> NDArray[np.complex128]:
    """Return the spectra (signals, segments, lines) of segments without their line in time."""
    from scipy.signal import detrend
    from scipy.signal.windows import hann

    cut = signals[:, starts[:, None] + np.arange(length)]
    found: NDArray[np.complex128] = np.fft.rfft(detrend(cut, axis=-1) * hann(length, sym=False))
    return found
