"""The sensor's reading is a nonlinear function of the output, or of its distance from a fold."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import knee, smooth_modes, spline
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# Pieces of the curve, the prior deviation of the second difference of its weights, and the largest
# of a mode, the straight one: the simulation's own gain has taken most of it.
_PIECES, _BEND, _STRAIGHT = 9, 0.05, 0.1
MODES = _PIECES + 2
_STEEPEST = 0.98  # part of the output's own slope that the curve takes away at most


@njit(cache=True, error_model="numpy")
def _read(
    y: np.ndarray, weights: np.ndarray, fold: float, corner: float, middle: float, half: float
) -> np.ndarray:
    result = np.empty(y.size)
    for k in range(y.size):
        read = y[k] + 2.0 * knee(fold - y[k], corner)
        place = 0.5 * _PIECES * (1.0 + min(max((read - middle) / half, -1.0), 1.0))
        result[k] = read + half * spline(place, weights)
    return result


def curve_modes() -> tuple[np.ndarray, np.ndarray]:
    """Return the weights (k, m) of each mode of the curve, and the modes' prior deviations.

    A smooth curve is more usual than a rough one, and goes on straight where no data tell it.
    """
    return smooth_modes(_PIECES, _BEND, _STRAIGHT)


def _rising(weights: np.ndarray) -> np.ndarray:
    """Return the weights of a curve, nowhere as steep that the reading would fall.

    The slope of a spline is a mean of the differences of its weights.
    """
    steps = np.maximum(np.diff(weights), -_STEEPEST * 2.0 / _PIECES)
    risen = np.concatenate([[0.0], np.cumsum(steps)])
    middle = weights.size // 2
    result: np.ndarray = risen + weights[middle] - risen[middle]
    return result


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Fold the output at a place, and bend it by a smooth curve."""
    fold, corner, middle, half = q[MODES:]
    result: np.ndarray = _read(y, _rising(curve_modes()[0] @ q[:MODES]), fold, corner, middle, half)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the curve's modes, place and corner of the fold, middle and half of the range."""
    low, high, span, unit = scales.y_low, scales.y_high, scales.y_span, scales.y_unit
    return (
        *(
            Parameter(f"mode_{n}", "1", 0.0, spread, -2.0, 2.0)
            for n, spread in enumerate(curve_modes()[1], 1)
        ),
        Parameter("fold", unit, low - span, span, low - 3.0 * span, high),
        Parameter(
            "corner_width", unit, 0.01 * span, 1.0, 1e-4 * span, 0.3 * span, log=True, shape=True
        ),
        Parameter("middle", unit, scales.y_middle, 0.0),
        Parameter("half_range", unit, 0.5 * span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return bends of one sign and of two, either way, and folds at the least reading and above."""
    low, span = scales.y_low, scales.y_span
    rest = (0.01 * span, 0.5 * (low + scales.y_high), 0.5 * span)
    bent = tuple(
        (*(size * float(n == mode) for n in range(MODES)), low - span, *rest)
        for mode in (1, 2)
        for size in (0.05, -0.05)
    )
    folded = tuple((*(0.0,) * MODES, low + part * span, *rest) for part in (0.01, 0.1))
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
