"""The input charges the device through a resistance."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import held_lag
from dea.discrepancy.parameter import Parameter


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass a held input through one slow and one faster first-order lag."""
    return held_lag(held_lag(u, q[0], interval), q[0] * q[1] + 1e-3 * interval, interval)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant and the ratio of the second, faster one."""
    dt = scales.interval
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.2 * scales.duration, log=True),
        Parameter("second_ratio", "1", 0.0, 0.3, 0.0, 1.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return time constants of a few intervals."""
    return tuple((samples * scales.interval, 0.1) for samples in (2.0, 8.0, 30.0))


EFFECT = Effect(
    name="electrode_lag",
    port=Port.INPUT,
    family=Family.LAG,
    signature="the device answers to a smoothed input",
    citation="Graf and Maas (2012), Smart Materials and Structures 21:094001, on electrode "
    "resistance",
    parameters=parameters,
    starts=starts,
    shape_input=law,
)
