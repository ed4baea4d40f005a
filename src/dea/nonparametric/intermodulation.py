"""Lines that a second-order response puts where the input holds nothing."""

from typing import NamedTuple

import numpy as np
from scipy.special import fdtri

from dea.arrays import Array, Complex
from dea.confidence import LEVEL
from dea.nonparametric.best_linear import BestLinear, Lines


class Intermodulation(NamedTuple):
    """Even lines of the output, measured and as a second-order response predicts them.

    ``ratio`` is the measured line over the predicted one, by least squares over realisations; 1
    where they agree. ``in_band`` is below 0 where pairs inside and outside the band cancel, and NaN
    where nothing is predicted.
    """

    lines: Lines  # (even lines,) harmonics of the period
    measured: Complex  # (realisations, even lines) two-sided Fourier coefficients
    predicted: Complex  # (realisations, even lines)
    in_band: Array  # (even lines,) 1 less |prediction by pairs outside the band|^2 / |prediction|^2
    ratio: Complex  # (even lines,)
    radius: Array  # (even lines,) of the 95 % disc around the ratio


def signed(lines: Lines) -> Lines:
    """Return the excited lines at negative and positive frequencies, ascending."""
    return np.concatenate([-lines[::-1], lines])


def intermodulation(found: BestLinear, H2: Complex, highest: int) -> Intermodulation:
    """Compare even lines with those of a second-order response.

    The output line at harmonic s is the sum of H2(f_k, f_l) U_k U_l over all ordered pairs of
    excited lines, of either sign, with k + l = s.

    Parameters
    ----------
    H2
        The response at all pairs of :func:`signed` lines, in output units per squared input unit.
    highest
        The band: pairs of lines up to this harmonic count as inside it.
    """
    lines = signed(found.lines)
    spectrum = found.input[:, np.abs(lines)]
    spectrum = np.where(lines < 0, spectrum.conj(), spectrum)
    contribution = H2 * spectrum[:, :, None] * spectrum[:, None, :]
    sums = lines[:, None] + lines[None, :]
    inside = (np.abs(lines) <= highest)[:, None] & (np.abs(lines) <= highest)[None, :]
    largest = min(2 * highest, found.output.shape[1] - 1)
    even = np.unique(sums[(sums > 0) & (sums <= largest)])
    predicted = np.stack([contribution[:, sums == s].sum(axis=-1) for s in even], axis=-1)
    within = np.stack([(contribution * inside)[:, sums == s].sum(axis=-1) for s in even], axis=-1)
    power = np.sum(np.abs(predicted) ** 2, axis=0)
    over_power = 1.0 / np.where(power > 0.0, power, np.nan)
    foreign = np.sum(np.abs(predicted - within) ** 2, axis=0) * over_power
    measured = found.output[:, even]
    ratio = np.sum(predicted.conj() * measured, axis=0) * over_power
    left = np.sum(np.abs(measured - ratio * predicted) ** 2, axis=0) / (found.realisations - 1)
    radius = np.sqrt(fdtri(2, 2 * (found.realisations - 1), LEVEL) * left * over_power)
    return Intermodulation(even, measured, predicted, 1.0 - foreign, ratio, radius)
