"""Nonlinear least squares by Levenberg-Marquardt, for costs that a simulation computes.

Levenberg (1944), Quarterly of Applied Mathematics 2:164; Marquardt (1963), SIAM Journal 11:431.
The caller evaluates the cost and linearises the residual; this module chooses damping and steps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Value = TypeVar("Value")
_SLOW_STEPS = 2


class Point(NamedTuple, Generic[Value]):
    """Parameters (k,), their cost (infinite where it does not exist), and what it comes from."""

    x: Array
    cost: float
    value: Value


class Model(NamedTuple):
    """The linearised problem at a point.

    Parameters
    ----------
    cost
        Cost at the point, to compare steps with.
    step
        ``step(damping)`` returns the step (k,) that minimises the damped model.
    exact
        Whether the model is of the point itself. One that reuses derivatives of another point may
        stall too early, and is then replaced by an exact one.
    """

    cost: float
    step: Callable[[float], Array]
    exact: bool = True


class Task(Protocol[Value]):
    """What is minimised."""

    def evaluate(self, x: Array) -> Point[Value]:
        """Return the cost at ``x``, or at the nearest point within bounds."""

    def linearise(self, point: Point[Value], iteration: int, exact: bool) -> Model | None:
        """Return the model at a point, an ``exact`` one if asked for; ``None`` ends the search."""


@dataclass(frozen=True)
class Damping:
    """How the damping follows success and failure.

    It starts at ``first``, is divided by ``fall`` down to ``least`` after a step that lowers the
    cost, and is multiplied by ten, ``tries`` times at most and up to ``most``, until one does.

    In a narrow curved valley the steps zigzag and hardly advance. Two successive steps that each
    lower the cost by less than ``slow`` (a part of it), at least one of them after a rejected
    step, are therefore followed by a search along the line through both (parallel tangents: Shah,
    Buehler and Kempthorne 1964, SIAM Journal 12:74). Zero turns this off.
    """

    first: float = 1e-3
    fall: float = 10.0
    least: float = 1e-13
    most: float = np.inf
    tries: int = 30
    slow: float = 0.0


def minimise(
    task: Task[Value], start: Array, damping: Damping, *, iterations: int, tolerance: float
) -> Point[Value]:
    """Return the point with the least cost that ``iterations`` steps from ``start`` reach.

    Ends earlier if a step of an exact model lowers the cost by no more than ``tolerance`` (a part
    of it), or if the start has no finite cost.
    """
    point = task.evaluate(start)
    now = damping.first
    exact = False
    trail = _Trail(damping.slow)
    for iteration in range(iterations):
        model = task.linearise(point, iteration, exact) if np.isfinite(point.cost) else None
        if model is None:
            break
        better: Point[Value] | None = None
        rejected = 0
        while rejected < damping.tries and now < damping.most:
            trial = task.evaluate(point.x + model.step(now))
            if trial.cost < model.cost:
                better = trial
                now = max(now / damping.fall, damping.least)
                break
            now *= 10.0
            rejected += 1
        gain = model.cost - better.cost if better else 0.0
        if better:
            direction = trail.along(point.x, better.x, gain / model.cost, rejected > 0)
            point = better if direction is None else _searched(task, better, direction)
            gain = model.cost - point.cost
        if gain <= tolerance * model.cost and model.exact:
            break
        exact = gain <= tolerance * model.cost
    return point


class _Trail:
    """The last steps: whether they zigzag, and the direction in which they advance."""

    def __init__(self, slow: float) -> None:
        self._slow = slow
        self._steps: list[tuple[Array, bool]] = []

    def along(self, before: Array, after: Array, gain: float, rejected: bool) -> Array | None:
        """Note a step; return the sum of the last two if they were slow and one was damped."""
        if gain >= self._slow:
            self._steps.clear()
            return None
        self._steps = [*self._steps[1 - _SLOW_STEPS :], (after - before, rejected)]
        if len(self._steps) < _SLOW_STEPS or not any(damped for _, damped in self._steps):
            return None
        direction: Array = np.sum([step for step, _ in self._steps], axis=0)
        return direction


def _searched(task: Task[Value], point: Point[Value], direction: Array) -> Point[Value]:
    """Go from a point along a direction, twice as far each time, while the cost falls."""
    while True:
        further = task.evaluate(point.x + direction)
        if not further.cost < point.cost:
            return point
        point, direction = further, 2.0 * direction
