"""A quantity that a fit may change: its unit, prior and bounds."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from dea.errors import InputError


@dataclass(frozen=True)
class Parameter:
    """A parameter of a simulation or of an effect.

    Parameters
    ----------
    nominal
        Prior mean, in ``unit``.
    spread
        Prior standard deviation, in ``unit``, or of the natural logarithm if ``log``. Zero means
        that the value is known and no fit changes it.
    low, high
        Bounds, in ``unit``.
    log
        Whether the fit works with the logarithm; the value is then positive.
    shape
        Whether it only shapes a law. A fit then holds it until place and size of the effect are
        found: freed earlier, it would adapt to an effect in the wrong place.
    at_start
        Whether it belongs to the state at the start of a record, and is fitted anew to another.
    event
        Whether it says when something happened or how long that took, which only the samples around
        that instant tell.
    at_port
        Of a law at a force port, whose motion and force are normalised: whether it is a ``place``,
        a ``length`` or a ``rate`` of the motion, or a ``force`` or a ``stiffness``.

    Raises
    ------
    InputError
        If the spread is negative, the bounds are crossed, or a logarithm's nominal value is not
        positive.
    """

    name: str
    unit: str
    nominal: float
    spread: float
    low: float = -np.inf
    high: float = np.inf
    log: bool = False
    shape: bool = False
    at_start: bool = False
    event: bool = False
    at_port: Literal["", "place", "length", "rate", "force", "stiffness"] = ""

    def __post_init__(self) -> None:
        if not 0.0 <= self.spread < np.inf:
            raise self._error("spread", f"it is {self.spread:g}", "Give a deviation, or zero")
        if self.low > self.high:
            problem = f"it is {self.low:g}, and high is {self.high:g}"
            raise self._error("low", problem, "Give the smaller bound as low")
        if self.log and self.nominal <= 0.0:
            raise self._error(
                "nominal", f"it is {self.nominal:g}, without a logarithm", "Leave log out"
            )

    def _error(self, field: str, problem: str, remedy: str) -> InputError:
        return InputError(problem, field=f"parameters.{self.name}.{field}", remedy=remedy)

    def value(self, coordinate: float) -> float:
        """Return the value at a ``coordinate`` counted in spreads from the nominal value."""
        step = self.spread * coordinate
        value = self.nominal * float(np.exp(min(step, 50.0))) if self.log else self.nominal + step
        return min(max(value, self.low), self.high)

    def coordinate(self, value: float) -> float:
        """Return how many spreads ``value`` is away from the nominal value."""
        inside = min(max(value, self.low), self.high)
        if self.log:
            return float(np.log(inside / self.nominal)) / self.spread
        return (inside - self.nominal) / self.spread

    def coordinate_bounds(self) -> tuple[float, float]:
        """Return the bounds as coordinates."""
        low = -np.inf if self.log and self.low <= 0 else self.low
        return (
            self.coordinate(low) if np.isfinite(low) else -np.inf,
            self.coordinate(self.high) if np.isfinite(self.high) else np.inf,
        )
