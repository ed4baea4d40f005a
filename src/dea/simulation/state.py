"""A state of a simulation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class State:
    """A state variable: its value at the start of a record, and how uncertain that value is.

    ``spread`` is the prior standard deviation of ``initial``, in ``unit``. Zero means that the
    state settles during the simulation's lead-in, and no fit changes it.
    """

    name: str
    unit: str
    initial: float
    spread: float = 0.0
