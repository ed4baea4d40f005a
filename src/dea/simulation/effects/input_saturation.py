"""The input saturates at a limit."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import limited
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Limit either sign softly, and keep a part ``slope`` of what is lost by that."""
    limit, sharpness, slope, ratio = q[0], q[1], q[2], q[3]
    result = np.empty(u.size)
    for k in range(u.size):
        if u[k] >= 0.0:
            inside = limited(u[k], limit, sharpness)
        else:
            inside = -limited(-u[k], limit * ratio, sharpness)
        result[k] = inside + slope * (u[k] - inside)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return limit, sharpness of its corner, remaining slope, ratio of the negative limit."""
    peak = scales.u_peak
    return (
        Parameter("limit", scales.u_unit, 0.8 * peak, 0.3 * peak, 0.05 * peak, 3.0 * peak),
        Parameter("sharpness", "1", 8.0, 1.0, 1.0, 200.0, log=True, shape=True),
        Parameter("remaining_slope", "1", 0.0, 0.1, 0.0, 0.6, shape=True),
        Parameter("negative_ratio", "1", 1.0, 0.5 if scales.bipolar else 0.0, 0.0, 5.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return limits in the upper half of the input's range."""
    return tuple(
        (scales.u_high - part * scales.u_span, sharpness, 0.0, 1.0)
        for part, sharpness in ((0.07, 60.0), (0.2, 30.0), (0.35, 8.0), (0.1, 3.0))
    )


EFFECT = Effect(
    name="input_saturation",
    port=Port.INPUT,
    family=Family.LIMIT,
    symptom="beyond a limit of the input the simulation goes on and the device does not",
    citation="Hu and Lin (2001), Control Systems with Actuator Saturation, chapter 1",
    parameters=parameters,
    starts=starts,
    shape_input=law,
)
