"""What a model's structure lacks, as its response: the model error model.

The error of a free run whose parameters follow the record holds what the terms cannot describe: a
creep slower than their lags, for instance. Its response to the input, over that of the output, is
how far the model's response is off in gain and phase (L. Ljung, Automatica 35, 1999, 403). Both are
parallel Hammerstein models about the operating point, so that the response to small inputs and that
to their squares are told apart from the average over the record's large ones. They are measured
with the record's own excitation, so that they tell how large the error of a response is, and not
what the response should be.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array
from dea.gfrf.relative_error import SHARED, RelativeError, relative_error
from dea.inputs import by_input
from dea.missing import filled
from dea.narx import NarxModel, as_input, simulate_varying

# With which noise alone is taken for an error: at any of the lines, and around each of them.
_CHANCE = 0.01
# Deviation of the logarithm of the frequency over which neighbours count: for whether there is an
# error, and for its size.
_SEEN, _AROUND = 1.0, 0.5
# Share of a regressor's variance that those before it must leave unexplained; and its deviation,
# relative to its root mean square, below which it varies by rounding alone.
_OWN, _ROUNDING = 1e-6, 1e-9
# Share of an input's power at a line that the higher powers must leave unexplained. The segments of
# a periodic record are alike, so that at each line one regressor explains the others.
_TOLD_APART = 1e-4


@dataclass(frozen=True)
class ModelErrorModel:
    """Standard deviations of relative gains and of phases (rad) by frequency in Hz.

    Parameters
    ----------
    frequency : (lines,)
    gain, phase : (inputs, lines)
        Of what an input drives.
    pair_gain, pair_phase : (pairs, lines)
        Of what the product of two inputs drives; pairs as ``combinations_with_replacement`` of the
        inputs orders them. NaN where the record does not tell, as of an input that is periodic or
        has two levels.
    """

    frequency: Array
    gain: Array
    phase: Array
    pair_gain: Array
    pair_phase: Array

    def first(self, frequency: Array, number: int = 1) -> tuple[Array, Array]:
        """Return gain and phase of H1 of an input; beyond the lines, of the nearest."""
        return self._at(frequency, self.gain[number - 1], self.phase[number - 1])

    def product(self, frequency: Array, numbers: Sequence[int] = (1, 1)) -> tuple[Array, Array]:
        """Return gain and phase of what the product of two inputs drives at a frequency."""
        inputs = range(1, len(self.gain) + 1)
        pair = (min(numbers), max(numbers))
        row = list(combinations_with_replacement(inputs, 2)).index(pair)
        return self._at(frequency, self.pair_gain[row], self.pair_phase[row])

    def second(self, f1: Array, f2: Array, numbers: Sequence[int] = (1, 1)) -> tuple[Array, Array]:
        """Return gain and phase of H2(f1, f2) of two inputs; zero where the record does not tell.

        What their product drives is measured at the sum of the frequencies, over all pairs that
        have it. What differs between these pairs is taken to be as large as the errors of H1 at
        the two frequencies and their sum: if the square of a device's state acts on it, H2 is a
        constant times these three. The sum counts for the first input.
        """
        parts = [
            self.first(f1, numbers[0]),
            self.first(f2, numbers[1]),
            self.first(np.add(f1, f2), numbers[0]),
            self.product(np.add(f1, f2), numbers),
        ]
        gain, phase = (np.sqrt(sum(np.square(part[k]) for part in parts)) for k in (0, 1))
        return np.nan_to_num(gain), np.nan_to_num(phase)

    def _at(self, frequency: Array, *values: Array) -> tuple[Array, Array]:
        gain, phase = (np.interp(np.abs(frequency), self.frequency, each) for each in values)
        return gain, phase

    @classmethod
    def of(cls, responses: xr.Dataset) -> "ModelErrorModel | None":
        """Return that of one input, as :func:`dea.gfrf.response_over_time` gives it, if it does."""
        if "model_error_gain" not in responses or responses["model_error_gain"].isnull().any():
            return None
        found = [
            responses[f"{prefix}model_error_{part}"].values[None]
            for prefix in ("", "H2_")
            for part in ("gain", "phase")
        ]
        gain, phase, pair_gain, pair_phase = found
        return cls(
            responses["frequency"].values,
            gain,
            np.radians(phase),
            pair_gain,
            np.radians(pair_phase),
        )


def model_error(
    model: NarxModel,
    parameters: Array,
    u: ArrayLike,
    y: ArrayLike,
    sampling_rate: float,
    excited_above: float,
    operating_point: ArrayLike | None = None,
) -> ModelErrorModel | None:
    """Return what the model lacks, or None where the record does not tell.

    It does not where the free run diverges, an input is constant or made up by others, or the
    record is too short (:func:`dea.gfrf.relative_error.relative_error`).

    Parameters
    ----------
    model, parameters
        With parameters (samples, terms) that follow the record.
    u, y
        The record in physical units, (samples,) or (samples, inputs); missing outputs are NaN.
    excited_above
        Share of the largest power density of an input above which a frequency counts as excited.
    operating_point
        Inputs about which the responses are taken, in physical units; by default the middle ones.
    """
    scaling, signals = model.scaling, as_input(u)
    outputs, seen = filled(np.asarray(y, dtype=float))
    normalised = scaling.normalise_input(signals)
    run = simulate_varying(model.terms, parameters, normalised, scaling.normalise_output(outputs))
    error = outputs - scaling.restore_output(run)
    middle = scaling.u_offset if operating_point is None else operating_point
    about = (np.asarray(middle, dtype=float) - scaling.u_offset) / scaling.u_scale
    powers, told = _powers(by_input(normalised - about))
    if not told[: model.inputs].all():
        return None
    known = seen & np.isfinite(error)

    def measured(regressors: Array) -> RelativeError | None:
        return relative_error(
            regressors, model.inputs, outputs, error, known, sampling_rate, excited_above
        )

    found = measured(powers)
    if found is None or found.told_apart < _TOLD_APART:
        found = measured(powers[: model.inputs])
        told[model.inputs :] = False
    if found is None:
        return None
    every = np.full((2, told.size, found.frequency.size), np.nan)
    every[:, told] = _deviations(found)[:, : told.sum()]
    (gain, pair_gain), (phase, pair_phase) = (np.split(each, [model.inputs]) for each in every)
    return ModelErrorModel(found.frequency, gain, phase, pair_gain, pair_phase)


def _powers(inputs: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return inputs, their products, cubes and fourth powers (regressors, samples).

    The higher ones keep what they drive apart from what inputs and products do. One that those
    before it make up, as all but the first of an input with two levels, is left out. And which of
    the inputs and products there are.
    """
    pairs = combinations_with_replacement(inputs, 2)
    products = [first * second for first, second in pairs]
    every = np.array([*inputs, *products, *inputs**3, *inputs**4])
    whole = np.linalg.norm(every, axis=1)
    centred = every - every.mean(axis=1, keepdims=True)
    size = np.linalg.norm(centred, axis=1)
    basis, kept = np.empty_like(every), np.zeros(len(every), bool)
    for row, each in enumerate(centred):
        before = basis[: kept.sum()]
        own = each - (before @ each) @ before
        left = np.linalg.norm(own)
        if left > max(np.sqrt(_OWN) * size[row], _ROUNDING * whole[row]):
            basis[len(before)] = own / left
            kept[row] = True
    return every[kept], kept[: len(inputs) + len(products)]


def _deviations(found: RelativeError) -> Array:
    """Return the standard deviations (2, regressors, lines) of gain and phase.

    An error counts at a line where it is beyond what chance makes at any line, and its mean around
    a line where that is beyond chance: an error that the noise hides at one line is about as large
    as at its neighbours. The larger of the two counts, of gain and phase each. Either is the square
    of what was measured, to which the uncertainty of the measurement is added: so far may the error
    be.
    """
    from scipy.stats import f, gamma

    frequency, relative, variance, free, _ = found
    near, wide = (_weights(frequency, width) for width in (_AROUND, _SEEN))
    sizes = [part**2 + 0.5 * variance for part in (relative.real, relative.imag)]
    power = np.abs(relative) ** 2
    # The power of noise over its estimated mean is an F variable of 2 and 2 free degrees: of mean
    # free/(free - 1), and over that of variance free/(free - 2). A mean of lines is nearly a gamma
    # variable of its variance.
    here = power > f.ppf(1.0 - _CHANCE / frequency.size, 2.0, 2.0 * free) * variance
    ratio = np.divide(power, variance, out=np.zeros_like(power), where=variance > 0.0)
    shape = (1.0 - 2.0 / free) / _spread(wide)
    around = (1.0 - 1.0 / free) * ratio @ wide.T > gamma.ppf(1.0 - _CHANCE, shape) / shape
    return np.sqrt([np.maximum(each * here, (each @ near.T) * around) for each in sizes])


def _weights(frequency: Array, width: float) -> Array:
    """Return the weights (lines, lines) of neighbours, which sum to one at each line."""
    weights = np.exp(-0.5 * (np.log(frequency[:, None] / frequency) / width) ** 2)
    found: Array = weights / weights.sum(axis=1, keepdims=True)
    return found


def _spread(weights: Array) -> Array:
    """Return the variance (lines,) of weighted means of lines, over that of one line."""
    spread: Array = np.sum(weights**2, axis=1)
    for apart, shared in enumerate(SHARED, 1):
        spread += 2.0 * shared * np.sum(weights[:, apart:] * weights[:, :-apart], axis=1)
    return spread
