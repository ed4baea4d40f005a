"""The sensor's reading is a curve of the output, or of its magnitude."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.parameter import Parameter


@njit(cache=True)
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Bend the output by Legendre polynomials of degree 2 to 4, and rectify a part of it."""
    result = np.empty(y.size)
    for k in range(y.size):
        bent = (1.0 - q[3]) * y[k] + q[3] * abs(y[k])
        x = (bent - q[4]) / q[5]
        x = min(max(x, -3.0), 3.0)
        even, odd = 1.5 * x * x - 0.5, 2.5 * x * x * x - 1.5 * x
        fourth = (35.0 * x**4 - 30.0 * x * x + 3.0) / 8.0
        result[k] = bent + q[5] * (q[0] * even + q[1] * odd + q[2] * fourth)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the curve's weights, the rectified part, and the middle and half of the range."""
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    return (
        Parameter("second_degree", "1", 0.0, 0.1, -2.0, 2.0),
        Parameter("third_degree", "1", 0.0, 0.05, -2.0, 2.0),
        Parameter("fourth_degree", "1", 0.0, 0.03, -2.0, 2.0),
        Parameter("rectified_part", "1", 0.0, 0.3 if scales.bipolar else 0.0, 0.0, 1.0),
        Parameter("middle", scales.y_unit, middle, 0.0),
        Parameter("half_range", scales.y_unit, half, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a bent curve and, where the input has both signs, the magnitude."""
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    bent = (0.02, 0.0, 0.0, 0.0, middle, half)
    rectified = (0.0, 0.0, 0.0, 1.0, middle, half)
    return (bent, rectified) if scales.bipolar else (bent,)


EFFECT = Effect(
    name="sensor_nonlinearity",
    port=Port.OUTPUT,
    family=Family.CURVE,
    signature="the gap is a curve of the simulated output, at any rate of the input",
    citation="Wigren (1993), Automatica 29:943, on output nonlinearities (Wiener systems)",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
