"""A heated chamber: a resistor heats a plate, the plate the air, and the air loses to the room.

Temperatures above the room's, by Newton's law of cooling::

    Ṫ₁ = p u² − a (T₁ − T₂),   Ṫ₂ = b (T₁ − T₂) − h T₂
"""

from typing import NamedTuple

from numba import njit

from dea.arrays import Array
from dea.plant.film import SUBSTEP

ROOM = 20.0  # °C


class Chamber(NamedTuple):
    """The parameters: heating p (K/(s V²)), exchange a and b (1/s) and loss h (1/s)."""

    heating: float = 0.11
    exchange: float = 0.12
    uptake: float = 0.05
    loss: float = 0.025


@njit(cache=True, error_model="numpy")
def heat(chamber: Chamber, state: Array, command: Array, temperature: Array) -> None:
    """Advance by one sub-step per element of ``command`` (V), filling ``temperature`` (°C).

    ``state`` holds T₁ and T₂ and changes in place, by the midpoint rule; ``temperature[k]`` is the
    value before ``command[k]`` takes effect.
    """
    p, a, b, h = chamber
    for k in range(command.shape[0]):
        plate, air = state[0], state[1]
        temperature[k] = ROOM + air
        power = p * command[k] ** 2
        half_plate = plate + 0.5 * SUBSTEP * (power - a * (plate - air))
        half_air = air + 0.5 * SUBSTEP * (b * (plate - air) - h * air)
        state[0] = plate + SUBSTEP * (power - a * (half_plate - half_air))
        state[1] = air + SUBSTEP * (b * (half_plate - half_air) - h * half_air)
