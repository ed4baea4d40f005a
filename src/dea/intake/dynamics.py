"""Lags, delay and settling time of a record, from linear models tried on a part they did not see.

Several orders and delays are estimated by least squares on one part and simulated on another. The
smallest that comes near the best is taken: L. Ljung, System Identification, 2nd ed., 1999, 16.4.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import ceil

import numpy as np

from dea.arrays import Array
from dea.inputs import input_count
from dea.narx import NarxModel, Scaling, candidate_terms, estimate, rmse, scaling_of

_ORDERS = (1, 2, 3, 4)
_DELAYS = 24  # samples; the largest that is tried
_NEAR = 1.1  # times the least error that a smaller model may leave
_EXACT = 1e-6  # error, of the output's spread, below which models differ by rounding alone
_LEARNT = 2 / 3  # share of the samples that parameters come from
_SETTLED = 0.02  # of the step's final value
_PER_UNKNOWN = 8  # samples


@dataclass(frozen=True)
class Dynamics:
    """What linear models say of a record.

    Parameters
    ----------
    y_lags
        Largest output lag.
    u_lags
        Lags of each input, the first of which is its delay.
    settling
        Samples until the response to a step stays within 2 % of its end.
    error
        Root mean square error of the free run on the unseen part over the output's standard
        deviation there.
    """

    y_lags: int
    u_lags: tuple[tuple[int, ...], ...]
    settling: int
    error: float

    @property
    def slowest(self) -> float:
        """Time constant, in samples, of a first-order lag that settles as slowly."""
        return max(self.settling, 2) / -float(np.log(_SETTLED))

    @property
    def longest(self) -> int:
        """The largest lag of an input."""
        return max(lags[-1] for lags in self.u_lags)


def samples_needed(inputs: int) -> int:
    """Return the fewest samples from which :func:`linear_dynamics` finds a model."""
    return ceil(_PER_UNKNOWN * _unknowns(inputs, min(_ORDERS)) / _LEARNT)


def linear_dynamics(u: Array, y: Array) -> Dynamics:
    """Return order and delay of the smallest linear model that simulates nearly as well as any.

    Parameters
    ----------
    u, y
        A stretch without a missing sample, shape (samples,), of :func:`samples_needed` at least;
        several inputs are the columns of ``u``.
    """
    inputs = input_count(u)
    split = int(_LEARNT * y.size)
    longest = min(_DELAYS, split // (4 * _PER_UNKNOWN))
    orders = [order for order in _ORDERS if _PER_UNKNOWN * _unknowns(inputs, order) <= split]
    delays = [1, 0, *range(2, longest + 1)]
    # One of several inputs may rest in the part that parameters come from.
    scaling = scaling_of([(u, y)]) if inputs > 1 else None
    unseen = partial(_unseen, u, y, split, scaling)
    # A delay other than one sample is taken where it simulates clearly better; that of each input
    # is sought with those of the inputs before it.
    found = (1,) * inputs
    for column in range(inputs):
        coarse = {d: _replaced(found, column, d) for d in delays}
        errors = {d: unseen(min(2, orders[-1]), coarse[d])[0] for d in delays}
        found = coarse[min(delays, key=lambda d: errors[d])]
    near = {
        _replaced(found, column, d)
        for column, delay in enumerate(found)
        for d in (1, max(delay - 1, 0), delay, delay + 1)
    }
    tried = {(n, d): unseen(n, d) for n, d in product(orders, sorted(near))}
    least = min(error for error, _ in tried.values())
    order, found = min(
        (key for key, (error, _) in tried.items() if error <= _NEAR * max(least, _EXACT)),
        key=lambda key: (key[0], sum(d != 1 for d in key[1]), key[1]),
    )
    error, model = tried[order, found]
    lags = tuple(tuple(range(delay, delay + order)) for delay in found)
    return Dynamics(order, lags, _settling(model, y.size, inputs), error)


def _unknowns(inputs: int, order: int) -> int:
    return (1 + inputs) * order + 1


def _replaced(delays: tuple[int, ...], column: int, delay: int) -> tuple[int, ...]:
    return (*delays[:column], delay, *delays[column + 1 :])


def _unseen(
    u: Array,
    y: Array,
    split: int,
    scaling: Scaling | None,
    order: int,
    delays: tuple[int, ...],
) -> tuple[float, NarxModel]:
    lags = [list(range(delay, delay + order)) for delay in delays]
    terms = candidate_terms(order, lags, 1, len(delays))
    model = estimate(terms, u[:split], y[:split], scaling=scaling)
    start = model.max_lag
    run = model.simulate(u[split:], y[split:])[start:]
    measured = y[split:][start:]
    spread = float(np.std(measured))
    error = rmse(measured, run) if np.isfinite(run).all() else np.inf
    return (error / spread if spread > 0.0 else np.inf), model


def _settling(model: NarxModel, longest: int, inputs: int) -> int:
    """Return the samples that a response to a small step of any input takes to stay near its end.

    The slowest input counts.
    """
    scaling = model.scaling
    middle = np.broadcast_to(scaling.u_offset, (longest, inputs))
    start = np.full(model.max_lag, scaling.y_offset)
    rest = model.simulate(middle, start)
    slowest = 1
    for step in np.diag(np.broadcast_to(scaling.u_scale, inputs)):
        run = model.simulate(middle + step, start)
        if not np.isfinite([run, rest]).all():
            return longest
        response = run - rest
        off = np.abs(response - response[-1]) > _SETTLED * np.abs(response[-1])
        slowest = max(slowest, int(np.flatnonzero(off)[-1]) + 1 if off.any() else 1)
    return slowest


def written(u_lags: Sequence[Sequence[int]]) -> int | list[int] | list[list[int]]:
    """Return input lags as a case file has them: the largest where all are alike and begin at 1."""
    first = u_lags[0]
    if any(lags != first for lags in u_lags):
        return [list(lags) for lags in u_lags]
    return first[-1] if first[0] == 1 else list(first)
