"""The inputs of a simulation and of a record: one, or several side by side."""

from dataclasses import dataclass

import numpy as np

# What separates the name of an effect from its place, and effects from each other.
RESERVED = "@+>"


@dataclass(frozen=True)
class Input:
    """An input: its name and unit, and the prior deviation of a constant added to it."""

    name: str
    unit: str
    offset_spread: float = 0.0


def joined(inputs: list[np.ndarray]) -> np.ndarray:
    """Return inputs, each (n,), as they were before :func:`dea.inputs.by_input`."""
    return inputs[0] if len(inputs) == 1 else np.column_stack(inputs)
