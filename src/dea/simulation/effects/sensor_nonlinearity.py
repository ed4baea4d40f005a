"""The sensor's reading is a nonlinear function of the output, or of its distance from a fold."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import knee, spline
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

INTERVALS = 9
# Cubic B-splines that are not zero somewhere in the range.
WEIGHTS = INTERVALS + 3


@njit(cache=True, error_model="numpy")
def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Fold the output at a place, and bend it by cubic B-splines.

    Splines act locally: where a fit has seen no data the curve stays unchanged.
    """
    fold, corner, middle, half = q[WEIGHTS], q[WEIGHTS + 1], q[WEIGHTS + 2], q[WEIGHTS + 3]
    result = np.empty(y.size)
    for k in range(y.size):
        read = y[k] + 2.0 * knee(fold - y[k], corner)
        place = 0.5 * INTERVALS * (1.0 + min(max((read - middle) / half, -1.0), 1.0))
        result[k] = read + half * spline(place, q[:WEIGHTS])
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the curve's weights, place and corner of the fold, middle and half of the range."""
    low, high, span, unit = scales.y_low, scales.y_high, scales.y_span, scales.y_unit
    return (
        *(Parameter(f"bend_{n}", "1", 0.0, 0.1, -2.0, 2.0) for n in range(1, WEIGHTS + 1)),
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
    parabola = np.linspace(-1.0, 1.0, WEIGHTS) ** 2 - 1.0 / 3.0
    bent = tuple((*size * parabola, low - span, *rest) for size in (0.075, -0.075))
    folded = tuple((*(0.0,) * WEIGHTS, low + part * span, *rest) for part in (0.01, 0.1))
    return (*bent, *folded)


EFFECT = Effect(
    name="sensor_nonlinearity",
    port=Port.OUTPUT,
    family=Family.CURVE,
    symptom="the residual is a function of the simulated output, at any rate of the input",
    citation="Wigren (1993), Automatica 29:943, on output nonlinearities (Wiener systems)",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
