"""A trial of controllers on an actuator: what drives it, and what came of that."""

from collections.abc import Callable
from typing import NamedTuple

import xarray as xr

from dea.arrays import Array
from dea.control.design import Controller
from dea.control.feedback import Gains


class ControlScheme(NamedTuple):
    """What makes a controller, or the voltages of an inverse that is played.

    A controller has gains; the inverse of a simulation, an error that is left with it, and the
    effects that are attached to it.
    """

    new: Callable[[], Controller] | None = None
    voltage: Array | None = None
    gains: Gains | None = None
    error: float = float("nan")
    effects: str = ""


class Followed(NamedTuple):
    """What came of one controller: its record, or why it was stopped."""

    record: xr.Dataset | None
    reference: Array
    outcome: str
    fallbacks: int
    scheme: ControlScheme
