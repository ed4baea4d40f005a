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


class Objective(Protocol[Value]):
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
    """

    first: float = 1e-3
    fall: float = 10.0
    least: float = 1e-13
    most: float = np.inf
    tries: int = 30


def minimise(
    objective: Objective[Value],
    start: Array,
    damping: Damping,
    *,
    iterations: int,
    tolerance: float,
) -> Point[Value]:
    """Return the point with the least cost that ``iterations`` steps from ``start`` reach.

    Ends earlier if a step of an exact model lowers the cost by no more than ``tolerance`` (a part
    of it), or if the start has no finite cost.
    """
    point = objective.evaluate(start)
    now = damping.first
    exact = False
    for iteration in range(iterations):
        model = objective.linearise(point, iteration, exact) if np.isfinite(point.cost) else None
        if model is None:
            break
        gain, begun = 0.0, now
        for _ in range(damping.tries):
            if now >= damping.most:
                break
            tried = objective.evaluate(point.x + model.step(now))
            if tried.cost < model.cost:
                point, gain = tried, model.cost - tried.cost
                now = max(now / damping.fall, damping.least)
                break
            now *= 10.0
        if gain <= tolerance * model.cost and model.exact:
            break
        if not gain:
            # What failed was the model, not the length of its steps.
            now = begun
        exact = gain <= tolerance * model.cost
    return point
