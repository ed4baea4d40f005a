"""Gauges of flow and level, whose readings are bent."""

import numpy as np
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.hidden.effect import Built, Conditions, reporting
from dea.plant.hidden.forms.kernels import true_at_ends


@reporting("King, Phil. Trans. R. Soc. A 214 (1914) 373: the voltage of a hot wire in a flow")
def hot_wire(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The root of 1 + b √v, true at both ends; the flow v rises or falls by 20 ``size`` from 1."""
    cooled, falls = rng.uniform(0.8, 3.0), rng.random() < 0.5

    def voltage(y: Array) -> Array:
        away = conditions.top - y if falls else y - conditions.bottom
        flow = np.maximum(1.0 + 20.0 * size * away / conditions.travel, 0.05)
        value: Array = np.sqrt(1.0 + cooled * np.sqrt(flow))
        return value

    return Built(true_at_ends(voltage, conditions), {})


@reporting("Perry, Chemical Engineers' Handbook (1963): the volume in a cylinder that lies")
def tank_gauge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A level read as volume, true at both ends; the travel is 0.6 ``size`` of the tank's height.

    It lies near the bottom or near the top of the tank.
    """
    share = 0.6 * min(size, 1.5)
    apart = 0.02 + rng.uniform(0.0, 0.2) * (0.96 - share)
    lowest = apart if rng.random() < 0.5 else 1.0 - share - apart

    def volume(y: Array) -> Array:
        level = np.clip(lowest + share * (y - conditions.bottom) / conditions.travel, 0.0, 1.0)
        above = 1.0 - 2.0 * level
        value: Array = np.arccos(above) - above * np.sqrt(1.0 - above * above)
        return value

    return Built(true_at_ends(volume, conditions), {})
