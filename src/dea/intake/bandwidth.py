"""Up to which frequency a signal holds power, and how far apart samples may be to show it."""

import numpy as np

from dea.arrays import Array

_POWER = 0.995  # share of the power above the noise that the band holds
_PER_PERIOD = 20  # samples in a period of the highest frequency of the output
_SEGMENTS = 8  # of the record, half overlapping


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
