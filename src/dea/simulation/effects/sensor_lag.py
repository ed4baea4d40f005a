"""The sensor responds with a lag."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, low_pass
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# Time constant of the fast part over that of the slow one: about the mean of the further modes of
# heat that diffuses into a sphere, whose times fall as 1/n² (0.13 by their parts).
_FAST = 0.15


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass the output through a second-order lag, which may ring, and read it late.

    A part of it passes through a faster lag instead, as in a body that warms from outside.
    """
    time_constant, damping, delay_ratio, fast = q
    samples = time_constant / interval
    smooth = low_pass(y, [(0.5 * samples / damping) ** 2, samples, 1.0])
    if fast > 0.0:
        smooth = (1.0 - fast) * smooth + fast * low_pass(y, [_FAST * samples, 1.0])
    return delayed(smooth, time_constant * delay_ratio, interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant 2ζ/ω₀, the damping ratio ζ, dead time over it, and the fast part."""
    dt = scales.interval
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.3 * scales.duration, log=True),
        Parameter("damping", "1", 1.5, 0.7, 0.15, 5.0, log=True, shape=True),
        Parameter("delay_ratio", "1", 0.0, 0.5, 0.0, 3.0, shape=True),
        Parameter("fast_part", "1", 0.0, 0.15, 0.0, 0.9, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return time constants of a few intervals."""
    return tuple((samples * scales.interval, 1.5, 0.0, 0.0) for samples in (2.0, 8.0, 30.0))


EFFECT = Effect(
    name="sensor_lag",
    port=Port.OUTPUT,
    family=Family.LAG,
    symptom="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, on second-order instruments; "
    "Carslaw and Jaeger (1959), Conduction of Heat in Solids, on their modes",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
