"""The input is delayed."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, delayed_smoothly, held_lag
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Delay the input, a fraction of an interval included, spread it, and let it return once.

    What arrives is spread by a first-order lag, as where a flow is mixed, or by streams of unequal
    speed, as where it is laminar: their part is ``streams``. A wave that is reflected at both ends
    arrives again after three times as long, with a part ``echo`` of the input. The delay is the
    mean one of what arrives first.
    """
    delay, spread, streams, echo, smooth = q
    first = (1.0 - spread) * delay
    shifted = delayed_smoothly if smooth else delayed
    mixed = shifted(held_lag(u, spread * delay, interval), first, interval)
    arriving: np.ndarray = mixed
    if streams > 0.0 and spread * delay > 0.0:
        apart = shifted(_of_streams(u, first, spread, interval), first, interval)
        arriving = (1.0 - streams) * mixed + streams * apart
    if echo != 0.0:
        arriving = (1.0 - echo) * arriving + echo * shifted(arriving, 2.0 * delay, interval)
    return arriving


def _of_streams(u: np.ndarray, first: float, spread: float, interval: float) -> np.ndarray:
    """Return the means over intervals of a held input (n,) behind streams of unequal speed.

    Counted from the ``first`` arrival d, a part 1 - (d/t)^(1/``spread``) of them has arrived by
    t > d; those of a laminar flow have a spread of one half. Their mean is d/(1 - spread).
    """
    from scipy.signal import fftconvolve

    power = 1.0 / spread
    late = first + interval * np.maximum(np.arange(-1, u.size + 1), 0)
    # The integral over time of the part that has arrived.
    arrived = late - first - first * (1.0 - (late / first) ** (1.0 - power)) / (power - 1.0)
    weights = np.diff(arrived, 2) / interval
    result: np.ndarray = u[0] + fftconvolve(u - u[0], weights)[: u.size]
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the delay, its spread and how it is spread, the echo, and if the input is smooth."""
    longest = min(0.1 * scales.duration, 500 * scales.interval)
    return (
        Parameter("delay", "s", 0.0, 4 * scales.interval, 0.0, longest),
        Parameter("spread", "1", 0.0, 0.1, 0.0, 0.5, shape=True),
        Parameter("streams", "1", 0.0, 0.5, 0.0, 1.0, shape=True),
        Parameter("echo", "1", 0.0, 0.1, -0.3, 0.3, shape=True),
        Parameter("smooth", "1", float(scales.smooth), 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return delays of a few intervals, sharp and spread."""
    smooth = float(scales.smooth)
    waiting = ((1.5, 0.0, 0.0), (4.5, 0.0, 0.0), (10.5, 0.0, 0.0), (10.5, 0.3, 0.7))
    return tuple(
        (samples * scales.interval, spread, streams, 0.0, smooth)
        for samples, spread, streams in waiting
    )


EFFECT = Effect(
    name="transport_delay",
    port=Port.INPUT,
    family=Family.LAG,
    symptom="the device does what the simulation does, a fixed time later",
    citation="Normey-Rico and Camacho (2007), Control of Dead-time Processes, chapter 2; "
    "Danckwerts (1953), Chemical Engineering Science 2:1, on its spread and on laminar flow; "
    "Wylie and Streeter (1978), Fluid Transients, on reflections",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    defining="delay",
)
