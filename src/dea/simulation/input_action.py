"""What the input does, where that depends on the input and the parameters alone."""

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
    """

    law: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    derivative: Callable[..., Any]
