"""The input is delayed."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Shift the input by a delay, a fraction of an interval included."""
    return delayed(u, q[0], interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the delay."""
    longest = min(0.1 * scales.duration, 500 * scales.interval)
    return (Parameter("delay", "s", 0.0, 4 * scales.interval, 0.0, longest),)


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return delays of a few intervals."""
    return tuple((samples * scales.interval,) for samples in (1.5, 4.5, 10.5))


EFFECT = Effect(
    name="transport_delay",
    port=Port.INPUT,
    family=Family.LAG,
    symptom="the device does what the simulation does, a fixed time later",
    citation="Normey-Rico and Camacho (2007), Control of Dead-time Processes, chapter 2",
    parameters=parameters,
    starts=starts,
    shape_input=law,
)
