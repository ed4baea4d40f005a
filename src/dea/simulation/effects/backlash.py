"""What is read follows the output with play: it stands still while a gap is crossed."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

_LEAST = 0.05  # part of the gap that is left where it is narrowest


@njit(cache=True, error_model="numpy")
def _read(y: np.ndarray, q: np.ndarray, kept: float) -> np.ndarray:
    """Drag what is read along; of what is beyond the gap a part is ``kept`` over an interval."""
    gap, tilt, growth, _, begun, middle, half_range = q
    result = np.empty(y.size)
    read = 0.0
    for k in range(y.size):
        place = min(max((y[k] - middle) / half_range, -1.0), 1.0)
        half = 0.5 * gap * max(1.0 + tilt * place + growth * place * place, _LEAST)
        if k == 0:
            read = y[0] - begun * half
        inside = min(max(read, y[k] - half), y[k] + half)
        read = inside + kept * (read - inside)
        result[k] = read
    return result


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Drag the reading along by either end of a gap, within which it stands still.

    The gap may be wider towards one end of the range (``tilt``) or both (``growth_at_ends``). The
    contact may give: the reading then lags behind what drags it by a time constant ``drag``.
    ``place`` is where the output stands in the gap at the first sample: 1 at the end that drags the
    reading up, -1 at the other.
    """
    drag = q[3]
    result: np.ndarray = _read(y, q, np.exp(-interval / drag) if drag > 0.0 else 0.0)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the gap, how it changes along the range, the drag, and the place at the start."""
    dt, span, unit = scales.interval, scales.y_span, scales.y_unit
    return (
        Parameter("gap", unit, 0.1 * span, 1.5, 1e-4 * span, 0.8 * span, log=True),
        Parameter("tilt", "1", 0.0, 0.3, -1.0, 1.0, shape=True),
        Parameter("growth_at_ends", "1", 0.0, 0.3, -1.0, 2.0, shape=True),
        Parameter("drag", "s", 0.0, 2.0 * dt, 0.0, 0.1 * scales.duration, shape=True),
        Parameter("place", "1", 0.0, 0.5, -1.0, 1.0, at_start=True),
        Parameter("middle", unit, scales.y_middle, 0.0),
        Parameter("half_range", unit, 0.5 * span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a narrow and a wide gap, from either end and the middle."""
    span, middle = scales.y_span, scales.y_middle
    return tuple(
        (part * span, 0.0, 0.0, 0.0, place, middle, 0.5 * span)
        for part in (0.03, 0.15)
        for place in (-0.9, 0.0, 0.9)
    )


EFFECT = Effect(
    name="backlash",
    port=Port.OUTPUT,
    family=Family.DISSIPATION,
    symptom="after each reversal the reading stands still for the same distance, at any rate",
    citation="Tao and Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor "
    "Nonlinearities, on backlash at the output; Vörös (2010), Automatica 46:369, on flanks of "
    "unequal slopes; Nordin and Gutman (2002), Automatica 38:1633, on a contact that gives",
    parameters=parameters,
    starts=starts,
    shape_output=law,
    defining="gap",
)
