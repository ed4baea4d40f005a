"""The noise floor: what no simulation could explain."""

import numpy as np

# Samples a block needs, and the ratio of two quarter bands that is no chance.
_SHORTEST = 24
_COLOURED = 1.5


def white_level(gap: np.ndarray, blocks: list[slice]) -> float:
    """Return the standard deviation of white noise that explains the upper half of the band.

    Excitation and slow misfit live at low frequency. The median over the upper half of each
    block's periodogram, divided by the median of the chi-squared distribution with two degrees
    of freedom over its mean (ln 2), estimates the level whatever lines stand out of it; the
    lower of two quarter bands is taken where they differ, so that no resonance in one counts.
    """
    quarters: list[list[np.ndarray]] = [[], []]
    for block in blocks:
        part = gap[block]
        if part.size < _SHORTEST or not np.isfinite(part).all():
            continue
        x = np.arange(part.size)
        part = part - np.polynomial.polynomial.Polynomial.fit(x, part, 2)(x)
        window = np.hanning(part.size)
        power = np.abs(np.fft.rfft(part * window)) ** 2 / np.sum(window**2)
        half, three_quarters = power.size // 2, 3 * power.size // 4
        quarters[0].append(power[half:three_quarters])
        quarters[1].append(power[three_quarters:-1])
    if not quarters[0]:
        return float(np.std(gap[np.isfinite(gap)]))
    both = [np.concatenate(quarter) for quarter in quarters]
    levels = [float(np.median(quarter)) / np.log(2.0) for quarter in both]
    if max(levels) < _COLOURED * min(levels):
        return float(np.sqrt(np.median(np.concatenate(both)) / np.log(2.0)))
    return float(np.sqrt(min(levels)))
