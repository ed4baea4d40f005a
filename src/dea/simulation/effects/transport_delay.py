"""The input is delayed."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, delayed_smoothly, held_lag
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Shift the input by a delay, a fraction of an interval included, and spread it.

    A part of the delay is that of a first-order lag: what flows or diffuses arrives earlier and
    later than on average.
    """
    delay, spread, smooth = q
    shifted = delayed_smoothly if smooth else delayed
    return shifted(held_lag(u, spread * delay, interval), (1.0 - spread) * delay, interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the mean delay, the part of it by which it is spread, and if the input is smooth."""
    longest = min(0.1 * scales.duration, 500 * scales.interval)
    return (
        Parameter("delay", "s", 0.0, 4 * scales.interval, 0.0, longest),
        Parameter("spread", "1", 0.0, 0.1, 0.0, 0.4, shape=True),
        Parameter("smooth", "1", float(scales.smooth), 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return delays of a few intervals."""
    smooth = float(scales.smooth)
    return tuple((samples * scales.interval, 0.0, smooth) for samples in (1.5, 4.5, 10.5))


EFFECT = Effect(
    name="transport_delay",
    port=Port.INPUT,
    family=Family.LAG,
    symptom="the device does what the simulation does, a fixed time later",
    citation="Normey-Rico and Camacho (2007), Control of Dead-time Processes, chapter 2; "
    "Danckwerts (1953), Chemical Engineering Science 2:1, on its spread",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    defining="delay",
)
