"""A kind of force law: its force and what it remembers, as compiled functions of one signature.

A kind is compiled when the first law of it is put on a device, and no device is compiled anew.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import float64, njit, types

from dea.arrays import Array
from dea.by_address import address, called
from dea.plant.array import Values

_ROW = types.Array(float64, 1, "C")
_FORCE = float64(_ROW, _ROW, float64, float64)
_CARRY = types.void(_ROW, _ROW, float64, float64, float64)

force_at = called(_FORCE)
carry_at = called(_CARRY)


@njit(cache=True, error_model="numpy")
def unchanged(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the memory of a force that has none."""


@dataclass(frozen=True, eq=False)
class Kind:
    """What laws that differ in their constants alone have in common.

    Attributes
    ----------
    force
        Returns the force (N) from constants, memory, place (m) and velocity (m/s).
    carry
        Updates the memory, in place, over a sub-step from constants, memory, place and velocity at
        its end, and its length (s).
    """

    force: Callable[[Array, Array, float, float], float]
    carry: Callable[[Array, Array, float, float, float], None] = unchanged

    def addresses(self) -> tuple[int, int]:
        """Return where force and memory are compiled, for ``force_at`` and ``carry_at``."""
        return address(self.force, _FORCE), address(self.carry, _CARRY)

    def static(self, constants: Values, y: float) -> float:
        """Return the force at rest at a place, of a kind without memory."""
        return self.force(np.array(constants, dtype=np.float64), np.zeros(0), y, 0.0)
