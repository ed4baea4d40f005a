"""From physical units to those of a model's equation and back."""

from dataclasses import dataclass

import numpy as np

from dea.errors import InputError
from dea.narx.checks import Array


@dataclass(frozen=True)
class Scaling:
    """How physical signals become those of the equation: (u - u_offset)/u_scale, y likewise.

    The default leaves them as they are.
    """

    u_offset: float = 0.0
    u_scale: float = 1.0
    y_offset: float = 0.0
    y_scale: float = 1.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not np.isfinite(value) or (name.endswith("scale") and value <= 0.0):
                raise InputError(
                    f"it is {value}",
                    field=name,
                    remedy="Offsets are finite numbers, scales positive ones.",
                )

    def normalise_input(self, u: Array) -> Array:
        """Return the input in the units of the equation."""
        return (u - self.u_offset) / self.u_scale

    def normalise_output(self, y: Array) -> Array:
        """Return the output in the units of the equation."""
        return (y - self.y_offset) / self.y_scale

    def restore_input(self, u: Array) -> Array:
        """Return the equation's input in physical units."""
        return u * self.u_scale + self.u_offset

    def restore_output(self, y: Array) -> Array:
        """Return the equation's output in physical units."""
        return y * self.y_scale + self.y_offset
