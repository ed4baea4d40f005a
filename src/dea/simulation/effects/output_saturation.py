"""The sensor saturates at the ends of its range."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import limited
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

_LEAST = 1e-9  # of the ends: distance from the middle at which one still lies on its own side


@njit(cache=True, error_model="numpy")
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Limit the distance from ``middle`` softly at either end; keep a part of what is lost."""
    upper, lower, sharpness, slope, middle = q[0], q[1], q[2], q[3], q[4]
    least = _LEAST * max(abs(upper), abs(lower), abs(middle))
    result = np.empty(y.size)
    for k in range(y.size):
        if y[k] >= middle:
            inside = middle + limited(y[k] - middle, max(upper - middle, least), sharpness)
        else:
            inside = middle - limited(middle - y[k], max(middle - lower, least), sharpness)
        result[k] = inside + slope * (y[k] - inside)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return upper and lower end, sharpness of the corners, remaining slope, and the middle."""
    unit, low, high, span = scales.y_unit, scales.y_low, scales.y_high, scales.y_span
    middle = scales.y_middle
    return (
        Parameter("upper_end", unit, high, 0.3 * span, middle, high + 3.0 * span),
        Parameter("lower_end", unit, low - 0.2 * span, 0.3 * span, low - 3.0 * span, middle),
        Parameter("sharpness", "1", 8.0, 1.0, 1.0, 200.0, log=True, shape=True),
        Parameter("remaining_slope", "1", 0.0, 0.1, 0.0, 0.25, shape=True),
        Parameter("middle", unit, middle, 0.2 * span, low - span, high, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return hard and soft upper ends, near the top and deeper in, and a hard lower end."""
    low, high, span = scales.y_low, scales.y_high, scales.y_span
    middle, far = scales.y_middle, low - 2.0 * span
    return (
        (high - 0.01 * span, far, 60.0, 0.0, middle),
        (high - 0.1 * span, far, 30.0, 0.0, middle),
        (high - 0.2 * span, far, 8.0, 0.0, middle),
        (high, far, 3.0, 0.0, low),
        (high + 2.0 * span, low + 0.02 * span, 60.0, 0.0, middle),
    )


EFFECT = Effect(
    name="output_saturation",
    port=Port.OUTPUT,
    family=Family.LIMIT,
    symptom="the measured output stays at one value while the simulated one passes it",
    citation="Doebelin (2003), Measurement Systems, section 3.2, on range and threshold",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
