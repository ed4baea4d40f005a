"""A record on uniform times: jitter interpolated, gaps flagged, samples averaged."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError

# Times between samples, as shares of the usual one: how far apart neighbours may be that a value
# between them is interpolated from, how close one sample must be that it stands alone, and by how
# much rounding the interval may shift the last sample.
_NEIGHBOURS, _CLOSE, _SHIFT = 1.6, 0.25, 0.05
# Times for each sample that was measured, above which a time is taken to be wrong.
_MOST = 1000
# Of times that are taken to be rounded: how many steps at least are unlike most, and which share of
# all (fewer are missing samples), how far beyond the rounding a time may be from those of the rate,
# and how close its steps are to whole multiples of the rounding.
_UNLIKE, _SHARE, _BEYOND, _WHOLE = 5, 1 / 30, 1.2, 1e-3


class IntervalError(InputError):
    """The interval does not suit the record."""


class Uniform(NamedTuple):
    """Samples on uniform times; NaN in ``y`` where ``missing``: a gap of ``y`` or of ``u``."""

    time: Array
    u: Array
    y: Array
    missing: NDArray[np.bool_]


def usual_interval(time: Array) -> float:
    """Return the time between samples of a record with jitter and gaps, in units of ``time``.

    The least-squares slope over the samples counted in median steps, so that neither a gap nor
    jitter shifts it; in four digits where these place the last sample as well.

    Parameters
    ----------
    time
        Ascending, shape (samples,), two at least.
    """
    steps = np.diff(time)
    count = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(steps / np.median(steps)), 1.0))])
    centred = count - count.mean()
    slope = float(centred @ (time - time.mean()) / (centred @ centred))
    short = float(f"{slope:.4g}")
    return short if abs(short - slope) * count[-1] < _SHIFT * slope else slope


def are_gaps(steps: Array, interval: float) -> NDArray[np.bool_]:
    """Tell which steps from one sample to the next are so long that samples are missing in them.

    Parameters
    ----------
    steps
        Shape (steps,), in units of ``interval``, the time between samples.
    """
    return np.asarray(steps > _NEIGHBOURS * interval)


def samples_per_interval(time: Array, interval: float) -> int:
    """Return how many samples of a record's own rate an interval holds, rounded, one at least.

    Parameters
    ----------
    time
        Ascending, shape (samples,), two at least.
    interval
        In units of ``time``.
    """
    return max(round(interval / usual_interval(time)), 1)


class Rounding(NamedTuple):
    """What times are rounded to, in s, and how many samples there are in a second."""

    to: float
    rate: float


def rounding(time: Array) -> Rounding | None:
    """Return how the times of samples of one rate, none of them missing, are rounded.

    Only where it is so coarse that samples share a time or seem to be missing, as of 75 samples a
    second whose times are multiples of 10 ms.

    Parameters
    ----------
    time
        Shape (samples,), in s.
    """
    steps = np.diff(time)
    changes = np.flatnonzero(steps > 0) + 1
    if np.any(steps < 0) or changes.size < 2:
        return None
    to = float(steps[changes - 1].min())
    several = np.round(steps / to)
    kinds, counts = np.unique(several, return_counts=True)
    usual = kinds[np.argmax(counts)]
    unlike = steps.size - counts.max()
    if np.any(np.abs(steps / to - several) > _WHOLE) or kinds.size == 1:
        return None
    if usual > 0 and unlike < max(_UNLIKE, _SHARE * steps.size):
        return None
    count = np.arange(time.size) - 0.5 * (time.size - 1)
    off = time - time.mean() - count * (count @ time) / (count @ count)
    if np.ptp(off) > _BEYOND * to:
        return None
    first, last = changes[0], changes[-1]
    lasting = float(time[last] - time[first])
    rate = float(last - first) / lasting
    return Rounding(to, _shortest(rate, min(1.0 / rate, to) / lasting))


def _shortest(value: float, uncertain: float) -> float:
    """Return the number of fewest digits that differs by no more than an ``uncertain`` share."""
    rounded = (float(f"{value:.{digits}g}") for digits in range(1, 17))
    return next(each for each in rounded if abs(each - value) <= max(uncertain, 1e-15) * value)


def check_order(time: Array, instead: str = "its `sampling_interval`") -> None:
    """Refuse times (samples,) in s that do not ascend.

    Parameters
    ----------
    instead
        What may be given in place of the times, for the message.

    Raises
    ------
    InputError
        Naming the first sample at fault.
    """
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        at = int(back[0])
        first = "Delete one of them" if time[at + 1] == time[at] else "Sort the record"
        raise InputError(
            f"sample {at + 1} is at {time[at + 1]:.12g} s, the one before it at {time[at]:.12g} s",
            field="time",
            remedy=f"{first}, or give {instead} in place of the time column",
        )


def resample(time: Array, u: Array, y: Array, interval: float) -> Uniform:
    """Place samples of any times ``interval`` apart, from the first on.

    Where samples are closer together than that by a factor of 1.5 or more, they are first placed on
    a grid of their own rate, then averaged, those of each interval into one. Each signal is
    interpolated between the samples of its own that are known.

    Parameters
    ----------
    time, u, y
        Shape (samples,), time ascending in s; NaN where a value is missing. Several inputs
        are the columns of ``u``.

    Raises
    ------
    InputError
        If times do not ascend, or hardly any would hold a sample; :class:`IntervalError` if there
        would be fewer than two.
    """
    known = np.isfinite(time) & np.isfinite(u.reshape(y.size, -1)).all(axis=1) & np.isfinite(y)
    if np.count_nonzero(known) < 3:
        raise InputError(
            f"{np.count_nonzero(known)} samples have both input and output",
            remedy="Record at least three",
        )
    at = time[known]
    check_order(at)
    several = samples_per_interval(at, interval)
    step = interval / several
    count = (int((at[-1] - at[0]) / step + _CLOSE) + 1) // several * several
    if count < 2 * several:
        raise IntervalError(
            f"on times {interval:g} s apart a record of {at[-1] - at[0]:.4g} s holds"
            f" {count // several} samples",
            remedy="Give a shorter interval",
        )
    if count > _MOST * at.size:
        last = int(np.argmax(np.diff(at))) + 1
        raise InputError(
            f"on times {interval:g} s apart the record would hold {count:.4g} samples, of which"
            f" {at.size} were measured; its longest gap, of {at[last] - at[last - 1]:.4g} s, ends"
            f" at {at[last]:.6g} s",
            field="time",
            remedy="Correct the times or the interval, or cut the record at the gap",
        )
    grid = at[0] + step * np.arange(count)
    columns = u.reshape(y.size, -1).T
    placed = [_on_grid(time, values, grid, step) for values in (*columns, y)]
    missing = np.any([gap for _, gap in placed], axis=0)
    *u_grid, y_grid = (values for values, _ in placed)
    found = _averaged(grid - at[0], np.stack(u_grid, axis=1), y_grid, missing, several)
    return found._replace(u=found.u.reshape(-1, *u.shape[1:]))


def _on_grid(
    time: Array, values: Array, grid: Array, step: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Return a signal interpolated to times ``step`` apart, and which of them lie in its gaps."""
    known = np.isfinite(time) & np.isfinite(values)
    at = time[known]
    check_order(at)
    after = np.clip(np.searchsorted(at, grid), 1, at.size - 1)
    gap = at[after] - at[after - 1]
    nearest = np.minimum(np.abs(grid - at[after - 1]), np.abs(at[after] - grid))
    missing = are_gaps(gap, step) & (nearest > _CLOSE * step)
    return np.interp(grid, at, values[known]), missing


def _averaged(time: Array, u: Array, y: Array, missing: NDArray[np.bool_], several: int) -> Uniform:
    """Return means of ``several`` samples; one is missing where more than half of its own are.

    Interpolated ones count where fewer are missing: the mean of those that are there would belong
    to another time than that of the inputs.
    """
    lost = np.count_nonzero(missing.reshape(-1, several), axis=1) * 2 > several
    return Uniform(
        time.reshape(-1, several)[:, 0],
        u.reshape(-1, several, u.shape[1]).mean(axis=1),
        np.where(lost, np.nan, y.reshape(-1, several).mean(axis=1)),
        lost,
    )
