"""Up to which frequency a signal holds power, and how far apart samples may be, or are."""

import numpy as np

from dea.arrays import Array

_POWER = 0.995  # share of the power above the noise that the band holds
_PER_PERIOD = 20  # samples in a period of the highest frequency of the output
_SEGMENTS = 8  # of the record, half overlapping
# Changes of a signal that show how long it holds its values, the share of them that are as far
# apart as others, and the share of steps that are more than one of rounding.
_CHANGES, _REGULAR, _LARGER = 20, 0.95, 0.5


def band(signal: Array, sampling_rate: float) -> tuple[float, float]:
    """Return the lowest and highest frequency in Hz between which a signal holds its power.

    The median density of the upper half of the spectrum counts as noise. The lowest is one period
    in a segment of the estimate where nothing lower is resolved.
    """
    from scipy.signal import welch

    length = max(signal.size // _SEGMENTS, min(signal.size, 32))
    lines, density = welch(signal, sampling_rate, nperseg=length, detrend="linear")
    lines, density = lines[1:], density[1:]
    noise = float(np.median(density[lines.size // 2 :]))
    share = np.cumsum(np.maximum(density - noise, 0.0))
    if share[-1] <= 0.0:
        return float(lines[0]), float(lines[-1])
    share /= share[-1]
    low = int(np.searchsorted(share, 1.0 - _POWER))
    high = int(np.searchsorted(share, _POWER))
    return float(lines[low]), float(lines[min(high, lines.size - 1)])


def samples_to_average(y: Array, sampling_rate: float) -> int:
    """Return how many samples of an output may be averaged into one without loss of its band."""
    _, highest = band(y, sampling_rate)
    return max(int(sampling_rate / (_PER_PERIOD * highest)), 1)


def samples_held(y: Array) -> float:
    """Return for how many samples a signal holds each value, where it is read at a rate of its own.

    One, where values change at any sample, or by single steps of rounding: a slow signal that is
    rounded holds its values, too.
    """
    steps = np.abs(np.diff(y))
    changes = np.flatnonzero(steps)
    if changes.size < _CHANGES:
        return 1.0
    held, sizes = np.diff(changes), steps[changes]
    usual = float(np.median(held))
    regular = np.abs(held - usual) <= 1.0
    larger = sizes > 1.5 * sizes.min()
    if usual < 2.0 or np.mean(regular) < _REGULAR or np.mean(larger) < _LARGER:
        return 1.0
    return float(np.mean(held[regular]))
