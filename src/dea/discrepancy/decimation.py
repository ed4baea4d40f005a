"""Long records that are sampled much faster than they move, at fewer samples."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.evidence.noise import white_level
from dea.discrepancy.problem import Samples
from dea.inputs import by_input
from dea.missing import filled

# Samples that a period of the input keeps at least, and the part of the input's power that its band
# holds.
_PER_PERIOD, _BAND = 10.0, 0.999
# What the output may hold above the highest frequency that is kept, in its white noise.
_ABOVE = 2.0


def decimation_of(records: Sequence[Samples], size: int) -> int:
    """Return the factor by which records can be decimated, to no fewer samples than ``size``.

    Every input keeps ten samples in a period of its band, and what the output holds beyond the
    frequencies that are kept is noise.
    """
    wanted = max(sum(each.size for each in records) // size, 1)
    return min((_largest(each, wanted) for each in records), default=1)


def decimated(record: Samples, factor: int, *, held: bool) -> Samples:
    """Return a record with every ``factor``-th sample of its output.

    An input that is ``held`` between samples becomes its mean over the longer interval, which moves
    a device that is slow beside it as far; another one is taken where the output is.
    """
    size = record.size // factor * factor
    inputs = record.u[:size].reshape(-1, factor, *record.u.shape[1:])
    u = inputs.mean(axis=1) if held else inputs[:, 0]
    return Samples(u, record.y[:size:factor], record.interval * factor)


def _largest(record: Samples, wanted: int) -> int:
    """Return the largest factor, up to one that is ``wanted``, that a record allows."""
    if wanted == 1:
        return 1
    bands = [_band(u) for u in by_input(record.u)]
    allowed = [wanted, *(int(1.0 / (_PER_PERIOD * band)) for band in bands if band > 0.0)]
    y = filled(record.y)[0]
    frequency, power = _spectrum(y)
    beyond = np.cumsum(power[::-1])[::-1]
    noise = (_ABOVE * white_level(y, [slice(0, y.size)])) ** 2
    for factor in range(min(allowed), 1, -1):
        kept = 0.5 / factor
        if beyond[np.searchsorted(frequency, kept)] <= noise * (1.0 - kept / 0.5):
            return factor
    return 1


def _band(u: np.ndarray) -> float:
    """Return the frequency, in cycles per sample, below which nearly all power of ``u`` (n,) is."""
    frequency, power = _spectrum(u)
    within = np.cumsum(power)
    return float(frequency[np.searchsorted(within, _BAND * within[-1])])


def _spectrum(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies in cycles per sample, and the part of the variance at each."""
    window = np.hanning(x.size)
    power = np.abs(np.fft.rfft(window * (x - x.mean()))) ** 2
    power[1:] *= 2.0
    return np.fft.rfftfreq(x.size), power / (x.size * np.sum(window**2))
