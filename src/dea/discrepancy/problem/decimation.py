"""Long records that are sampled much faster than they move, at fewer samples."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.problem.noise import white_level
from dea.discrepancy.problem.problem import Samples
from dea.discrepancy.problem.spectrum import spectrum
from dea.inputs import by_input, joined
from dea.missing import filled
from dea.simulation import InputInterpolation, at_steps

# Samples that a period of the input keeps at least, and the part of the input's power that its band
# holds.
_PER_PERIOD, _BAND = 10.0, 0.999
# Weights of six means over intervals in a row in the value between the third and the fourth, which
# they give exactly for a polynomial of degree five.
_VALUE_BETWEEN_MEANS = np.array([1.0, -8.0, 37.0, 37.0, -8.0, 1.0]) / 60.0
# ``smooth`` is chosen if its squared error is below this part of that of the other interpolation.
_CLOSER = 0.1
# RMS that the output may have above the highest frequency kept, in units of its white noise there.
_ABOVE = 2.0


def decimation_of(records: Sequence[Samples], size: int) -> int:
    """Return the factor by which records can be decimated, to no fewer samples than ``size``.

    Every input keeps ten samples in a period of its band, and what the output holds beyond the
    frequencies that are kept is noise.
    """
    wanted = max(sum(each.size for each in records) // size, 1)
    return min((_largest(each, wanted) for each in records), default=1)


def interpolation_of(
    records: Sequence[Samples], factor: int, recorded: InputInterpolation
) -> InputInterpolation:
    """Return the input interpolation that best restores the recorded inputs after decimation.

    It is ``smooth`` if that leaves much less error than the interpolation ``recorded``; otherwise
    it is ``recorded``. At a jump of the input, ``smooth`` rings and is hardly better.
    """

    def error(how: InputInterpolation) -> float:
        return sum(
            float(np.sum((_rebuilt(u, factor, recorded, how) - _whole(u, factor)) ** 2) / np.var(u))
            for each in records
            for u in by_input(each.u)
            if np.ptp(u)
        )

    return "smooth" if error("smooth") < _CLOSER * error(recorded) else recorded


def decimated(
    record: Samples, factor: int, recorded: InputInterpolation, how: InputInterpolation
) -> Samples:
    """Return a record with every ``factor``-th sample of its output.

    ``recorded`` and ``how`` are the interpolation of the input before and after. If both hold it,
    each new sample is the mean of the input over the longer interval, which moves a slow device as
    far. If it was held and becomes smooth, the new samples are such that their means over the
    longer intervals are these means. Any other input is sampled at the instants of the output.
    """
    u = joined([_fewer(each, factor, recorded, how) for each in by_input(record.u)])
    return Samples(u, _whole(record.y, factor)[::factor], record.interval * factor)


def _fewer(
    u: np.ndarray, factor: int, recorded: InputInterpolation, how: InputInterpolation
) -> np.ndarray:
    """Return an input (n,) at every ``factor``-th sample, shape (n // factor,)."""
    whole = _whole(u, factor)
    if recorded != "zero":
        return whole[::factor]
    means: np.ndarray = whole.reshape(-1, factor).mean(axis=1)
    if how == "zero":
        return means
    around = np.concatenate([np.full(3, u[0]), means, np.full(2, u[-1])])
    return np.convolve(around, _VALUE_BETWEEN_MEANS, mode="valid")


def _rebuilt(
    u: np.ndarray, factor: int, recorded: InputInterpolation, how: InputInterpolation
) -> np.ndarray:
    """Return an input (n,) at the rate recorded, from a decimated one."""
    points = at_steps(_fewer(u, factor, recorded, how), factor, how)
    smooth_for_held = recorded == "zero" and how != "zero"
    return 0.5 * (points[:-1] + points[1:]) if smooth_for_held else points[:-1]


def _whole(x: np.ndarray, factor: int) -> np.ndarray:
    """Return the samples that make whole intervals of ``factor``."""
    return x[: x.size // factor * factor]


def _largest(record: Samples, wanted: int) -> int:
    """Return the largest factor, up to one that is ``wanted``, that a record allows."""
    if wanted == 1:
        return 1
    bands = [_band(u) for u in by_input(record.u)]
    allowed = [wanted, *(int(1.0 / (_PER_PERIOD * band)) for band in bands if band > 0.0)]
    y, known = filled(record.y)
    frequency, power = _parts(y)
    beyond = np.cumsum(power[::-1])[::-1]
    noise = (_ABOVE * white_level(y, [slice(0, y.size)], known)) ** 2
    for factor in range(min(allowed), 1, -1):
        kept = 0.5 / factor
        if beyond[np.searchsorted(frequency, kept)] <= noise * (1.0 - kept / 0.5):
            return factor
    return 1


def _band(u: np.ndarray) -> float:
    """Return the frequency, in cycles per sample, below which nearly all power of ``u`` (n,) is."""
    frequency, power = _parts(u)
    within = np.cumsum(power)
    return float(frequency[np.searchsorted(within, _BAND * within[-1])])


def _parts(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies in cycles per sample, and the part of the variance at each."""
    frequency, density = spectrum(x, 1.0)
    return frequency, density / x.size
