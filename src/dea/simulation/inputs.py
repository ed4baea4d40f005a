"""What is known of an input of a simulation."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Input:
    """An input: its name and unit, and the prior deviation of a constant added to it."""

    name: str
    unit: str
    offset_spread: float = 0.0


def each_of(given: Any) -> tuple[Any, ...]:
    """Return what belongs to every input, whether to one or to several."""
    return given if isinstance(given, tuple) else (given,)
