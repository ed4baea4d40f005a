"""The sensor smooths what it sees."""

import numpy as np

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import delayed
from dea.discrepancy.parameter import Parameter


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass the output through a second-order lag, which may ring, and read it late.

    The output is taken as straight between samples, and as at rest before the first.
    """
    from scipy.signal import cont2discrete, lfilter, lfilter_zi

    time_constant, damping, delay_ratio = q
    own = [(0.5 * time_constant / damping) ** 2, time_constant, 1.0]
    numerator, denominator, _ = cont2discrete(([1.0], own), interval, method="foh")
    weights = numerator.ravel()
    at_rest = y[0] * lfilter_zi(weights, denominator)
    smooth, _ = lfilter(weights, denominator, y, zi=at_rest)
    return delayed(smooth, time_constant * delay_ratio, interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the delay of slow signals, the damping ratio, and a dead time in such delays."""
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
    signature="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, on second-order instruments",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
