"""The noise floor: the level of white noise in a residual, and of rounding in a signal."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

# Least number of samples of a block, and the ratio of two quarter bands that chance hardly causes.
_SHORTEST = 24
_COLOURED = 1.5
# Length (samples) and least number of the pieces whose levels are compared, and the part of the
# record's level that the quietest quarter of them is below only if the noise varies with time.
_PIECE, _PIECES, _QUIET = 64, 12, 0.5
# Part of a block that is known at least; weights of a mean that takes off what is slow, and draws
# of white noise to see how much of it is left.
_KNOWN = 0.3
_SLOW = np.array([1.0, 3.0, 4.0, 3.0, 1.0]) / 12.0
_DRAWS = 8
# Part of the readings between the extremes that repeat the one before, at most, in a fine record.
_REPEATED = 0.01


def white_level(
    residual: np.ndarray, blocks: Sequence[slice], known: np.ndarray | None = None
) -> float:
    """Return the standard deviation of white noise that explains the upper half of the band.

    Excitation and model errors are at low frequency. The median over the upper half of each
    block's periodogram, divided by the median of the chi-squared distribution with two degrees
    of freedom over its mean (ln 2), is insensitive to spectral lines. Where the two
    quarter bands differ, the lower one is taken, so that a resonance in one does not count; where
    the apparent noise varies with time, the level of the quietest quarter of the time is. Samples
    that are not ``known`` (n, bool) are interpolated in ``residual`` and carry no noise of their
    own.
    """
    there = np.ones(residual.size, bool) if known is None else known
    spectra = [
        _upper_half(residual[block], there[block])
        for block in blocks
        if np.count_nonzero(there[block]) >= max(_SHORTEST, _KNOWN * there[block].size)
        and np.isfinite(residual[block]).all()
    ]
    if not spectra:
        usable = there & np.isfinite(residual)
        return float(np.std(residual[usable if usable.any() else np.isfinite(residual)]))
    quarters = [np.concatenate(halves) for halves in zip(*map(_halved, spectra), strict=True)]
    levels = [_level(quarter) for quarter in quarters]
    level = min(levels)
    if max(levels) < _COLOURED * level:
        level = _level(np.concatenate(quarters))
    pieces = [
        _level(_upper_half(residual[piece], there[piece]))
        for block in blocks
        for start in range(*block.indices(residual.size))[: 1 - _PIECE : _PIECE]
        if there[piece := slice(start, start + _PIECE)].mean() >= _KNOWN
        and np.isfinite(residual[piece]).all()
    ]
    if len(pieces) >= _PIECES:
        quiet = float(np.quantile(pieces, 0.25))
        level = quiet if quiet < _QUIET * level else level
    return float(np.sqrt(level))


def at_a_limit(y: np.ndarray) -> np.ndarray:
    """Return which readings (n,) a limit holds, whose noise does not show, (n, bool).

    They repeat the largest or the least reading of the record, while readings between hardly ever
    repeat: those of a coarse converter do, and show its noise all the same.
    """
    same = np.diff(y) == 0.0
    extreme = (y == y.max()) | (y == y.min())
    repeated = np.concatenate([same, [False]]) | np.concatenate([[False], same])
    between = same[~extreme[1:]]
    coarse = between.size > 0 and between.mean() > _REPEATED
    held: np.ndarray = extreme & repeated & (not coarse)
    return held


def quantisation(y: np.ndarray) -> float:
    """Return the standard deviation of the rounding of ``y`` (n,): its least step over √12.

    Zero for a signal whose values are all the same.
    """
    steps = np.diff(np.unique(y))
    steps = steps[steps > 1e-9 * np.ptp(y)]
    return float(steps.min() / np.sqrt(12.0)) if steps.size else 0.0


def _upper_half(part: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return the periodogram of a part of a residual, without its trend, above half the band.

    White noise of variance one has a mean of one in it.
    """
    x = np.arange(part.size)
    left = part - np.polynomial.polynomial.Polynomial.fit(x, part, 2)(x)
    if known.all():
        return _power(left, known)
    return _power(_without_slow(left, known), known) / _passed(known.tobytes())


def _power(signal: np.ndarray, known: np.ndarray) -> np.ndarray:
    window = np.hanning(signal.size)
    power = np.abs(np.fft.rfft(signal * known * window)) ** 2 / np.sum(window**2 * known)
    upper: np.ndarray = power[power.size // 2 : -1]
    return upper


def _without_slow(signal: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return a signal less the mean of the known samples around each, zero where not known.

    What is slow would else be spread over the band by the missing stretches.
    """
    weights = np.convolve(known, _SLOW, "same")
    mean = np.convolve(signal * known, _SLOW, "same") / np.where(known, weights, 1.0)
    return np.where(known, signal - mean, 0.0)


@lru_cache(maxsize=512)
def _passed(known: bytes) -> float:
    """Return the power that is left of white noise of variance one with these samples known."""
    there = np.frombuffer(known, bool)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (_DRAWS, there.size))
    return float(np.mean([_power(_without_slow(each, there), there) for each in signs]))


def _halved(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return power[: power.size // 2], power[power.size // 2 :]


def _level(power: np.ndarray) -> float:
    return float(float(np.median(power)) / np.log(2.0))
