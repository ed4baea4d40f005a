"""What is computed once for a run: from the input and the parameters, or from these alone."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class InputAction:
    """A second, quicker form of a simulation's equations.

    Parameters
    ----------
    law
        ``law(u, scale, p)`` returns the action (m,) of inputs ``u`` (m,) for the parameters ``p``,
        of which the drive is multiplied by ``scale`` (m,).
    derivative
        ``derivative(x, action, p, dx)`` writes what the simulation's own derivative does, with the
        action in place of the input. It does not use the drive.
    table
        ``table(p)`` returns ``p`` with numbers appended that depend on it alone, such as functions
        of the state at nodes, for this derivative; none where it takes ``p`` itself.
    """

    law: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    derivative: Callable[..., Any]
    table: Callable[[np.ndarray], np.ndarray] | None = None
