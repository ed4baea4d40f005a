"""The sensor's reading is a curve of the output, or of its distance from a place."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import knee
from dea.discrepancy.parameter import Parameter

DEGREES = 8


@njit(cache=True, error_model="numpy")
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Fold the output at a place, and bend it by Legendre polynomials of degree 2 to 9."""
    fold, corner, middle, half = q[DEGREES], q[DEGREES + 1], q[DEGREES + 2], q[DEGREES + 3]
    result = np.empty(y.size)
    for k in range(y.size):
        read = y[k] + 2.0 * knee(fold - y[k], corner)
        # Beyond the range the curve goes on straight: a polynomial would run away.
        x = min(max((read - middle) / half, -1.3), 1.3)
        before, legendre, bend = 1.0, x, 0.0
        for n in range(2, DEGREES + 2):
            before, legendre = legendre, ((2 * n - 1) * x * legendre - (n - 1) * before) / n
            bend += q[n - 2] * legendre
        result[k] = read + half * bend
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the curve's weights, place and corner of the fold, middle and half of the range."""
    low, high, span, unit = scales.y_low, scales.y_high, scales.y_span, scales.y_unit
    return (
        *(Parameter(f"degree_{n}", "1", 0.0, 0.2 / n, -2.0, 2.0) for n in range(2, DEGREES + 2)),
        Parameter("fold", unit, low - span, span, low - 3.0 * span, high),
        Parameter(
            "corner_width", unit, 0.01 * span, 1.0, 1e-4 * span, 0.3 * span, log=True, shape=True
        ),
        Parameter("middle", unit, 0.5 * (low + high), 0.0),
        Parameter("half_range", unit, 0.5 * span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return curves bent either way without a fold, and folds at and above the least reading."""
    low, span = scales.y_low, scales.y_span
    rest = (0.01 * span, 0.5 * (low + scales.y_high), 0.5 * span)
    straight = (0.0,) * (DEGREES - 1)
    bent = tuple((weight, *straight, low - span, *rest) for weight in (0.05, -0.05))
    folded = tuple((0.0, *straight, low + part * span, *rest) for part in (0.01, 0.1))
    return (*bent, *folded)


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
