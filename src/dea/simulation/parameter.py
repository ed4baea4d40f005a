"""A quantity that a fit may change: its unit, prior and bounds."""

from dataclasses import dataclass

import numpy as np


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
