"""Courses of drifts: by small amounts, by a regulator, of a reservoir, and of a heated room."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.hidden.effect import Conditions

Course = Callable[[Array], Array]


def gamma_process(conditions: Conditions, rng: Generator) -> Course:
    """Rise by thirty to eighty exponential amounts at equal intervals, to 1 at the end."""
    amounts = rng.exponential(1.0, int(rng.integers(30, 81)))
    risen = np.append(0.0, np.cumsum(amounts) / amounts.sum())
    times = np.linspace(0.0, conditions.duration, risen.size)
    return lambda t: np.interp(t, times, risen)


def regulated(conditions: Conditions, rng: Generator) -> Course:
    """Approach 1 by a swing of 0.4 to 0.9 durations that dies in 0.15 to 0.4."""
    angular = 2.0 * np.pi / (rng.uniform(0.4, 0.9) * conditions.duration)
    decay = 1.0 / (rng.uniform(0.15, 0.4) * conditions.duration)
    return lambda t: (
        1.0 - np.exp(-decay * t) * (np.cos(angular * t) + decay / angular * np.sin(angular * t))
    )


def emptied(conditions: Conditions, rng: Generator) -> Course:
    """Rise as a parabola, ever more slowly, to 1 after 0.5 to 1.2 durations."""
    time = rng.uniform(0.5, 1.2) * conditions.duration
    return lambda t: 1.0 - (1.0 - np.minimum(t / time, 1.0)) ** 2


def heated_for_a_while(conditions: Conditions, rng: Generator) -> Course:
    """Rise exponentially to 1 until 0.3 to 0.7 of the record, and fall exponentially from there."""
    off = rng.uniform(0.3, 0.7) * conditions.duration
    rise, fall = conditions.duration * np.array([rng.uniform(0.1, 0.4), rng.uniform(0.15, 0.6)])

    def course(t: Array) -> Array:
        warmed = np.expm1(-np.minimum(t, off) / rise) / np.expm1(-off / rise)
        value: Array = warmed * np.exp(-np.maximum(t - off, 0.0) / fall)
        return value

    return course
