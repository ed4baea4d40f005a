"""The noise floor: the level of white noise in a residual, and of rounding in a signal."""

import numpy as np

# Least number of samples of a block, and the ratio of two quarter bands that chance hardly causes.
_SHORTEST = 24
_COLOURED = 1.5
# Length (samples) and least number of the pieces whose levels are compared, and the part of the
# record's level that the quietest quarter of them is below only if the noise varies with time.
_PIECE, _PIECES, _QUIET = 64, 12, 0.5


def white_level(residual: np.ndarray, blocks: list[slice]) -> float:
    """Return the standard deviation of white noise that explains the upper half of the band.

    Excitation and model errors are at low frequency. The median over the upper half of each
    block's periodogram, divided by the median of the chi-squared distribution with two degrees
    of freedom over its mean (ln 2), is insensitive to spectral lines. Where the two
    quarter bands differ, the lower one is taken, so that a resonance in one does not count; where
    the apparent noise varies with time, the level of the quietest quarter of the time is.
    """
    spectra = [
        _upper_half(residual[block])
        for block in blocks
        if residual[block].size >= _SHORTEST and np.isfinite(residual[block]).all()
    ]
    if not spectra:
        return float(np.std(residual[np.isfinite(residual)]))
    quarters = [np.concatenate(halves) for halves in zip(*map(_halved, spectra), strict=True)]
    levels = [_level(quarter) for quarter in quarters]
    level = min(levels)
    if max(levels) < _COLOURED * level:
        level = _level(np.concatenate(quarters))
    pieces = [
        _level(_upper_half(residual[start : start + _PIECE]))
        for block in blocks
        for start in range(*block.indices(residual.size))[: 1 - _PIECE : _PIECE]
        if np.isfinite(residual[start : start + _PIECE]).all()
    ]
    if len(pieces) >= _PIECES:
        quiet = float(np.quantile(pieces, 0.25))
        level = quiet if quiet < _QUIET * level else level
    return float(np.sqrt(level))


def quantisation(y: np.ndarray) -> float:
    """Return the standard deviation of the rounding of ``y`` (n,): its least step over √12.

    Zero for a signal whose values are all the same.
    """
    steps = np.diff(np.unique(y))
    steps = steps[steps > 1e-9 * np.ptp(y)]
    return float(steps.min() / np.sqrt(12.0)) if steps.size else 0.0


def _upper_half(part: np.ndarray) -> np.ndarray:
    """Return the periodogram of a part of a residual, without its trend, above half the band."""
    x = np.arange(part.size)
    left = part - np.polynomial.polynomial.Polynomial.fit(x, part, 2)(x)
    window = np.hanning(part.size)
    power = np.abs(np.fft.rfft(left * window)) ** 2 / np.sum(window**2)
    return power[power.size // 2 : -1]


def _halved(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return power[: power.size // 2], power[power.size // 2 :]


def _level(power: np.ndarray) -> float:
    return float(float(np.median(power)) / np.log(2.0))
