"""A quantity that a fit may change: its unit, prior and bounds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from dea.errors import InputError

# Names of the parameters that every simulation has besides its own. Those of one of several inputs,
# of a state at the start and of a law have a point in their names.
INPUT_OFFSET, OUTPUT_GAIN, OUTPUT_OFFSET = "input_offset", "output_gain", "output_offset"
TIMING_OFFSET = "timing_offset"
GIVEN = (INPUT_OFFSET, OUTPUT_GAIN, OUTPUT_OFFSET, TIMING_OFFSET)


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
    reads
        Whether it changes what is read alone, and not the motion, which then need not be run anew.
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
    reads: bool = False
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
        return float(Scaling.of([self]).values(np.array([coordinate]))[0])

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


@dataclass(frozen=True)
class Scaling:
    """How the coordinates of several parameters become values; each field has the shape (k,)."""

    nominal: np.ndarray
    spread: np.ndarray
    low: np.ndarray
    high: np.ndarray
    log: np.ndarray

    @classmethod
    def of(cls, parameters: Sequence[Parameter]) -> "Scaling":
        """Return that of these parameters."""
        return cls(
            nominal=np.array([p.nominal for p in parameters]),
            spread=np.array([p.spread for p in parameters]),
            low=np.array([p.low for p in parameters]),
            high=np.array([p.high for p in parameters]),
            log=np.array([p.log for p in parameters], dtype=bool),
        )

    def values(self, coordinates: np.ndarray) -> np.ndarray:
        """Return the values (k,) at coordinates counted in spreads from the nominal values."""
        steps = self.spread * coordinates
        factors = np.exp(np.where(self.log, np.minimum(steps, 50.0), 0.0))
        moved = np.where(self.log, self.nominal * factors, self.nominal + steps)
        result: np.ndarray = np.minimum(np.maximum(moved, self.low), self.high)
        return result
