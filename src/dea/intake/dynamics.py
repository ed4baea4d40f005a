"""Lags, delay and settling time of a record, from linear models tried on a part they did not see.

Several orders and delays are estimated by least squares on one part and simulated on another. The
smallest that comes near the best is taken: L. Ljung, System Identification, 2nd ed., 1999, 16.4.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dea.narx import NarxModel, candidate_terms, estimate, rmse

Array = NDArray[np.float64]

_ORDERS = (1, 2, 3, 4)
_DELAYS = 24  # samples; the largest that is tried
_NEAR = 1.1  # times the least error that a smaller model may leave
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
        Input lags, the first of which is the delay.
    settling
        Samples until the response to a step stays within 2 % of its end.
    error
        Root mean square error of the free run on the unseen part over the output's standard
        deviation there.
    """

    y_lags: int
    u_lags: tuple[int, ...]
    settling: int
    error: float


def linear_dynamics(u: Array, y: Array) -> Dynamics:
    """Return order and delay of the smallest linear model that simulates nearly as well as any.

    Parameters
    ----------
    u, y
        A stretch without a missing sample, shape (samples,).
    """
    split = int(_LEARNT * u.size)
    longest = min(_DELAYS, split // (4 * _PER_UNKNOWN))
    orders = [order for order in _ORDERS if _PER_UNKNOWN * (2 * order + 1) <= split]
    delays = [1, 0, *range(2, longest + 1)]
    coarse = {d: _unseen(u, y, split, min(2, orders[-1]), d) for d in delays}
    # A delay other than one sample is taken where it simulates clearly better.
    delay = min(delays, key=lambda d: coarse[d][0])
    near = sorted({1, max(delay - 1, 0), delay, delay + 1})
    tried = {(n, d): _unseen(u, y, split, n, d) for n, d in product(orders, near)}
    least = min(error for error, _ in tried.values())
    order, delay = min(
        (key for key, (error, _) in tried.items() if error <= _NEAR * least),
        key=lambda key: (key[0], key[1] != 1, key[1]),
    )
    error, model = tried[order, delay]
    return Dynamics(order, tuple(range(delay, delay + order)), _settling(model, u.size), error)


def _unseen(u: Array, y: Array, split: int, order: int, delay: int) -> tuple[float, NarxModel]:
    terms = candidate_terms(order, list(range(delay, delay + order)), 1)
    model = estimate(terms, u[:split], y[:split])
    start = model.max_lag
    run = model.simulate(u[split:], y[split:])[start:]
    measured = y[split:][start:]
    spread = float(np.std(measured))
    error = rmse(measured, run) if np.isfinite(run).all() else np.inf
    return (error / spread if spread > 0.0 else np.inf), model


def _settling(model: NarxModel, longest: int) -> int:
    """Return the samples that the response to a small step takes to stay near its end."""
    scaling = model.scaling
    steps = np.full(longest, scaling.u_offset)
    rest = model.simulate(steps)
    response = model.simulate(steps + scaling.u_scale) - rest
    if not np.isfinite(response).all():
        return longest
    off = np.abs(response - response[-1]) > _SETTLED * np.abs(response[-1])
    return int(np.flatnonzero(off)[-1]) + 1 if off.any() else 1


def written(u_lags: Sequence[int]) -> int | list[int]:
    """Return input lags as a case file has them: the largest where they begin at 1."""
    return u_lags[-1] if u_lags[0] == 1 else list(u_lags)
