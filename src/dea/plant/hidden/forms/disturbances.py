"""Periodic disturbances of the reading, the command and the mass."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant import forces
from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _harmonics(c: Array, m: Array, y: Array) -> None:
    """c: frequency, then (height, phase) of every harmonic; added to the signal."""
    count = (c.shape[0] - 1) // 2
    for k in range(y.shape[0]):
        angle = 2.0 * np.pi * c[0] * m[0]
        for i in range(count):
            y[k] += c[1 + 2 * i] * np.sin((i + 1) * angle + c[2 + 2 * i])
        m[0] += SUBSTEP


def _frequency(conditions: Conditions, rng: Generator) -> float:
    """Return a frequency from a fifth of the band to six times it."""
    return float(10.0 ** rng.uniform(-0.7, 0.8) / conditions.time)


def _wave(
    size: float, conditions: Conditions, rng: Generator, heights: Array, *, output: bool = True
) -> Built:
    frequency = _frequency(conditions, rng)
    heights = np.asarray(heights) * size * (conditions.travel if output else conditions.span)
    phases = rng.uniform(0.0, 2.0 * np.pi, heights.size)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=output)
    return Built(law, {"frequency": frequency})


@tuning("Den Hartog, Mechanical Vibrations (1956): the harmonics of a reciprocating machine")
def machine_harmonics(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and two harmonics on the reading."""
    return _wave(size, conditions, rng, np.array([1.0, rng.uniform(0, 0.5), rng.uniform(0, 0.3)]))


@tuning("Mohan, Power Electronics (2003): ripple of a supply on the command")
def supply_ripple(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and its second harmonic added to the command."""
    heights = np.array([1.0, rng.uniform(0.0, 0.5)])
    return _wave(size, conditions, rng, heights, output=False)


@njit(cache=True)
def _beat(c: Array, m: Array, y: Array) -> None:
    """Two lines of slightly different frequency."""
    height, first, second, share, phase = c
    for k in range(y.shape[0]):
        y[k] += height * (
            np.sin(2.0 * np.pi * first * m[0] + phase) + share * np.sin(2.0 * np.pi * second * m[0])
        )
        m[0] += SUBSTEP


@reporting("Randall, Vibration-based Condition Monitoring (2011): two machines that beat")
def beating_machines(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A line and a weaker one two to six beats a record away."""
    first = _frequency(conditions, rng)
    second = first + rng.uniform(2.0, 6.0) / conditions.duration
    constants = [
        size * conditions.travel, first, second, rng.uniform(0.2, 0.6), rng.uniform(0, 2 * np.pi)
    ]  # fmt: skip
    return Built(SignalLaw(_beat, constants, output=True), {"frequency": first})


@reporting("Hanselman, Brushless Permanent Magnet Motor Design (2003): cogging", moving=True)
def cogging(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Equal pulses of force, many harmonics of one frequency."""
    from scipy.special import i0e

    frequency = 10.0 ** rng.uniform(-0.7, 0.2) / conditions.time
    narrow = rng.uniform(2.0, 6.0)
    height = size * conditions.stiffness * conditions.travel
    phase = rng.uniform(0.0, 2.0 * np.pi)
    constants = np.array([height, frequency, phase, narrow, i0e(narrow)])
    return Built(ForceLaw(forces.PULSES, constants, np.zeros(1)), {"frequency": frequency})


@reporting("Rao, Mechanical Vibrations (2017): the rectified sine of a loose contact")
def rectified_sine(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The positive half of a sine on the reading, by its first six harmonics."""
    frequency, phase = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi)
    order = np.arange(1, 7)
    # max(sin, 0) = 1/π + sin/2 - (2/π) Σ cos(2k x)/(4k² - 1)
    even = np.where(order % 2 == 0, -2.0 / np.pi / (order**2 - 1.0 + (order == 1)), 0.0)
    heights = 2.0 * size * conditions.travel * np.where(order == 1, 0.5, even)
    phases = order * phase + np.where(order == 1, 0.0, 0.5 * np.pi)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=True)
    return Built(law, {"frequency": frequency})


EFFECTS = (
    EffectKind(
        "periodic_disturbance", Port.OUTPUT, 0.002, 1.0, "travels",
        (machine_harmonics, supply_ripple, beating_machines, cogging, rectified_sine),
    ),
)  # fmt: skip
