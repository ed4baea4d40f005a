"""What is driven follows with play: it stands still while a gap is crossed."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

_LEAST = 0.05  # part of the gap that is left where it is narrowest


@njit(cache=True, error_model="numpy")
def _dragged(driver: np.ndarray, half: np.ndarray, begun: float, kept: float) -> np.ndarray:
    """Return what a ``driver`` (n,) drags along by either end of a gap of twice ``half`` (n,).

    Of what is beyond the gap a part is ``kept`` over an interval.
    """
    result = np.empty(driver.size)
    follower = driver[0] - begun * half[0]
    for k in range(driver.size):
        inside = min(max(follower, driver[k] - half[k]), driver[k] + half[k])
        follower = inside + kept * (follower - inside)
        result[k] = follower
    return result


def command(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Drag the input along, as a linkage with play does; ``command_place`` is where it begins."""
    driven: np.ndarray = _dragged(u, np.full(u.size, 0.5 * q[7]), q[8], 0.0)
    return driven


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Drag the reading along by either end of a gap, within which it stands still.

    The gap may be wider towards one end of the range (``tilt``) or both (``growth_at_ends``). The
    contact may give: the reading then lags behind what drags it by a time constant ``drag``.
    ``place`` is where the output stands in the gap at the first sample: 1 at the end that drags the
    reading up, -1 at the other.
    """
    gap, tilt, growth, drag, begun, middle, half_range = q[:7]
    place = np.clip((y - middle) / half_range, -1.0, 1.0)
    half = 0.5 * gap * np.maximum(1.0 + tilt * place + growth * place * place, _LEAST)
    read: np.ndarray = _dragged(y, half, begun, np.exp(-interval / drag) if drag > 0.0 else 0.0)
    return read


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the gap, how it changes along the range, the drag, and the place at the start.

    Then the middle and half the range of the output, and the gap that the input crosses, with its
    place at the start.
    """
    dt, span, unit = scales.interval, scales.y_span, scales.y_unit
    widest = 0.8 * scales.u_span
    return (
        Parameter("gap", unit, 0.0, 0.15 * span, 0.0, 0.8 * span, reads=True),
        Parameter("tilt", "1", 0.0, 0.3, -1.0, 1.0, shape=True, reads=True),
        Parameter("growth_at_ends", "1", 0.0, 0.3, -1.0, 2.0, shape=True, reads=True),
        Parameter("drag", "s", 0.0, 2.0 * dt, 0.0, 0.1 * scales.duration, shape=True, reads=True),
        Parameter("place", "1", 0.0, 0.5, -1.0, 1.0, at_start=True, reads=True),
        Parameter("middle", unit, scales.y_middle, 0.0),
        Parameter("half_range", unit, 0.5 * span, 0.0),
        Parameter("command_gap", scales.u_unit, 0.0, 0.15 * scales.u_span, 0.0, widest),
        Parameter("command_place", "1", 0.0, 0.5, -1.0, 1.0, at_start=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a narrow and a wide gap of reading or input, from either end and the middle."""
    middle, half = scales.y_middle, 0.5 * scales.y_span
    return tuple(
        (read * scales.y_span, 0.0, 0.0, 0.0, place, middle, half, driven * scales.u_span, place)
        for read, driven in ((0.03, 0.0), (0.15, 0.0), (0.0, 0.03), (0.0, 0.15))
        for place in (-0.9, 0.0, 0.9)
    )


EFFECT = Effect(
    name="backlash",
    port=Port.OUTPUT,
    family=Family.DISSIPATION,
    symptom="after each reversal the reading, or what the input does, stands still for the same "
    "distance, at any rate",
    citation="Tao and Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor "
    "Nonlinearities, on backlash at the input and the output; Vörös (2010), Automatica 46:369, "
    "on flanks of unequal slopes; Nordin and Gutman (2002), Automatica 38:1633, on a contact "
    "that gives",
    parameters=parameters,
    starts=starts,
    shape_input=command,
    shape_output=law,
)
