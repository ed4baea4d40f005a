"""The sensor's reading is a curve of the output, or of its magnitude."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.parameter import Parameter

DEGREES = 5


@njit(cache=True, error_model="numpy")
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Bend the output by Legendre polynomials of degree 2 to 6, and rectify a part of it."""
    rectified, middle, half = q[DEGREES], q[DEGREES + 1], q[DEGREES + 2]
    result = np.empty(y.size)
    for k in range(y.size):
        bent = (1.0 - rectified) * y[k] + rectified * abs(y[k])
        # Beyond the range the curve goes on straight: a polynomial would run away.
        x = min(max((bent - middle) / half, -1.3), 1.3)
        before, legendre, bend = 1.0, x, 0.0
        for n in range(2, DEGREES + 2):
            before, legendre = legendre, ((2 * n - 1) * x * legendre - (n - 1) * before) / n
            bend += q[n - 2] * legendre
        result[k] = bent + half * bend
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the curve's weights, the rectified part, and the middle and half of the range."""
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    return (
        *(Parameter(f"degree_{n}", "1", 0.0, 0.2 / n, -2.0, 2.0) for n in range(2, DEGREES + 2)),
        Parameter("rectified_part", "1", 0.0, 0.3 if scales.bipolar else 0.0, 0.0, 1.0),
        Parameter("middle", scales.y_unit, middle, 0.0),
        Parameter("half_range", scales.y_unit, half, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return curves bent either way and, where the input has both signs, the magnitude."""
    middle, half = 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span
    straight = (0.0,) * (DEGREES - 1)
    bent = tuple((weight, *straight, 0.0, middle, half) for weight in (0.05, -0.05))
    rectified = (0.0, *straight, 1.0, middle, half)
    return (*bent, rectified) if scales.bipolar else bent


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
