"""From physical units to those of a model's equation and back."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from dea.arrays import Array
from dea.errors import InputError
from dea.inputs import input_count
from dea.narx.simulation import BOUND

# Of measured outputs, so that a run has room to exceed them before it counts as diverged.
_LARGEST = BOUND / 3.0

PerInput = float | tuple[float, ...]


class OneInput(NamedTuple):
    """The scaling of a model with a single input, all numbers."""

    u_offset: float
    u_scale: float
    y_offset: float
    y_scale: float


@dataclass(frozen=True)
class Scaling:
    """How physical signals become those of the equation: (u - u_offset)/u_scale, y likewise.

    The default leaves them as they are. Of several inputs, ``u_offset`` and ``u_scale`` hold one
    number each; one number in a sequence is that of a single input.
    """

    u_offset: PerInput = 0.0
    u_scale: PerInput = 1.0
    y_offset: float = 0.0
    y_scale: float = 1.0

    def __post_init__(self) -> None:
        for name in ("u_offset", "u_scale"):
            values = getattr(self, name)
            if np.ndim(values):
                each = tuple(map(float, values))
                object.__setattr__(self, name, each[0] if len(each) == 1 else each)
        for name, value in vars(self).items():
            if not np.ndim(value):
                object.__setattr__(self, name, float(value))
        for name, value in vars(self).items():
            if not np.isfinite(value).all() or (name.endswith("scale") and np.min(value) <= 0.0):
                raise InputError(
                    f"it is {value}",
                    field=name,
                    remedy="Offsets are finite numbers, scales positive ones.",
                )
        if np.shape(self.u_offset) != np.shape(self.u_scale):
            raise InputError(
                f"{np.size(self.u_offset)} offsets and {np.size(self.u_scale)} scales",
                field="u_offset, u_scale",
                remedy="Give one of each for every input.",
            )

    @property
    def inputs(self) -> int | None:
        """The number of inputs that it is of; None where it treats any number alike."""
        return np.size(self.u_offset) if np.ndim(self.u_offset) else None

    def normalise_input(self, u: Array) -> Array:
        """Return the input in the units of the equation.

        Raises
        ------
        InputError
            If it is of another number of inputs.
        """
        if self.inputs and input_count(u) != self.inputs:
            raise InputError(
                f"{input_count(u)} of {self.inputs} inputs",
                field="u",
                remedy="Give all inputs that the model is of, as columns in their order.",
            )
        return (u - self.u_offset) / self.u_scale

    def normalise_output(self, y: Array) -> Array:
        """Return the output in the units of the equation.

        Raises
        ------
        InputError
            If it is so large there that every run like it would count as diverged.
        """
        found: Array = (y - self.y_offset) / self.y_scale
        large = np.flatnonzero(np.abs(found) > _LARGEST)
        if large.size:
            raise InputError(
                f"sample {large[0]} is {found[large[0]]:.4g} in the units of the equation, where"
                f" runs beyond {BOUND:.0e} count as diverged",
                field="y",
                remedy="Give it in larger units, or leave scaling out where the model is estimated",
            )
        return found

    def restore_input(self, u: Array) -> Array:
        """Return the equation's input in physical units."""
        return u * self.u_scale + self.u_offset

    def restore_output(self, y: Array) -> Array:
        """Return the equation's output in physical units."""
        return y * self.y_scale + self.y_offset


def require_scaling(scaling: Any) -> None:
    """Refuse what is given as a scaling and is none."""
    if not isinstance(scaling, Scaling):
        raise InputError(
            f"it is {type(scaling).__name__}",
            field="scaling",
            remedy="Give a dea.narx.Scaling, as Scaling(u_offset=0.5, u_scale=2.0)",
        )
