"""The sensor stops at the ends of its range."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import knee
from dea.discrepancy.parameter import Parameter


@njit(cache=True)
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Keep a part ``slope`` of what exceeds either end of the range."""
    result = np.empty(y.size)
    for k in range(y.size):
        excess = knee(y[k] - q[0], q[2]) - knee(q[1] - y[k], q[2])
        result[k] = y[k] - (1.0 - q[3]) * excess
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return upper and lower end, corner width and remaining slope."""
    unit, span = scales.y_unit, scales.y_span
    return (
        Parameter("upper_end", unit, scales.y_high, 0.3 * span),
        Parameter("lower_end", unit, scales.y_low - 0.2 * span, 0.3 * span),
        Parameter("corner_width", unit, 5e-3 * span, 1.5, 1e-4 * span, 0.5 * span, log=True),
        Parameter("remaining_slope", "1", 0.0, 0.1, 0.0, 0.6),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a range that ends near the top of the output, deeper in, and at its bottom."""
    low, high, span = scales.y_low, scales.y_high, scales.y_span
    return (
        (high - 0.01 * span, low - 0.3 * span, 0.01 * span, 0.0),
        (high - 0.1 * span, low - 0.3 * span, 0.02 * span, 0.0),
        (high - 0.3 * span, low - 0.3 * span, 0.05 * span, 0.1),
        (high + 0.3 * span, low + 0.02 * span, 0.01 * span, 0.0),
    )


EFFECT = Effect(
    name="output_saturation",
    port=Port.OUTPUT,
    family=Family.LIMIT,
    signature="the measured output stays at one value while the simulated one passes it",
    citation="Doebelin (2003), Measurement Systems, section 3.2, on range and threshold",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
