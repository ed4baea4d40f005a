"""The sensor responds with a lag."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, low_pass
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass the output through a second-order lag, which may ring, and read it late."""
    time_constant, damping, delay_ratio = q
    samples = time_constant / interval
    smooth = low_pass(y, [(0.5 * samples / damping) ** 2, samples, 1.0])
    return delayed(smooth, time_constant * delay_ratio, interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant 2ζ/ω₀, the damping ratio ζ, and a dead time in time constants."""
    dt = scales.interval
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.3 * scales.duration, log=True),
        Parameter("damping", "1", 1.5, 0.7, 0.15, 5.0, log=True, shape=True),
        Parameter("delay_ratio", "1", 0.0, 0.5, 0.0, 3.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return time constants of a few intervals."""
    return tuple((samples * scales.interval, 1.5, 0.0) for samples in (2.0, 8.0, 30.0))


EFFECT = Effect(
    name="sensor_lag",
    port=Port.OUTPUT,
    family=Family.LAG,
    symptom="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, on second-order instruments",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
