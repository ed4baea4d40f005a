"""The sensor smooths what it sees."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import delayed, sampled_lag
from dea.discrepancy.parameter import Parameter


@njit(cache=True, error_model="numpy")
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass the output through one slow and one faster first-order lag, and read it late."""
    smooth = sampled_lag(sampled_lag(y, q[0], interval), q[0] * q[1] + 1e-3 * interval, interval)
    return delayed(smooth, q[0] * q[2], interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant, and ratios to it of the second, faster one and of the delay."""
    dt = scales.interval
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.2 * scales.duration, log=True),
        Parameter("second_ratio", "1", 0.0, 0.3, 0.0, 1.0, shape=True),
        Parameter("delay_ratio", "1", 0.0, 0.5, 0.0, 3.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return time constants of a few intervals."""
    return tuple((samples * scales.interval, 0.1, 0.0) for samples in (2.0, 8.0, 30.0))


EFFECT = Effect(
    name="sensor_lag",
    port=Port.OUTPUT,
    family=Family.LAG,
    signature="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, first-order instruments",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
