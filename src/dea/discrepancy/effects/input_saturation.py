"""The input stops growing beyond a limit."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import knee
from dea.discrepancy.parameter import Parameter


@njit(cache=True)
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Keep a part ``slope`` of what exceeds the limit."""
    limit, width, slope, ratio = q[0], q[1], q[2], q[3]
    result = np.empty(u.size)
    for k in range(u.size):
        excess = knee(u[k] - limit, width) - knee(-u[k] - limit * ratio, width)
        result[k] = u[k] - (1.0 - slope) * excess
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return limit, corner width, remaining slope and the ratio of the negative limit."""
    peak = scales.u_peak
    return (
        Parameter("limit", scales.u_unit, 0.8 * peak, 0.3 * peak, 0.0, 1.5 * peak),
        Parameter("corner_width", scales.u_unit, 0.02 * peak, 1.5, 1e-3 * peak, peak, log=True),
        Parameter("remaining_slope", "1", 0.0, 0.1, 0.0, 0.6),
        Parameter("negative_ratio", "1", 1.0, 0.5 if scales.bipolar else 0.0, 0.0, 5.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return limits in the upper half of the input's range."""
    return tuple(
        (scales.u_high - part * scales.u_span, width * scales.u_peak, 0.0, 1.0)
        for part, width in ((0.07, 0.02), (0.2, 0.02), (0.35, 0.1), (0.5, 0.3))
    )


EFFECT = Effect(
    name="input_saturation",
    port=Port.INPUT,
    family=Family.LIMIT,
    signature="beyond a limit of the input the simulation goes on and the device does not",
    citation="Hu and Lin (2001), Control Systems with Actuator Saturation, chapter 1",
    parameters=parameters,
    starts=starts,
    shape_input=law,
)
