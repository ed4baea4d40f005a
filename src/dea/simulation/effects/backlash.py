"""What is read follows the output with play: it stands still while a gap is crossed."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# Contacts of which each closes at a gap of its own, where the corners of the loop are rounded.
_CONTACTS = 5


@njit(cache=True, error_model="numpy")
def _read(y: np.ndarray, gap: float, rounding: float, place: float) -> np.ndarray:
    result = np.zeros(y.size)
    for i in range(_CONTACTS):
        half = 0.5 * gap * (1.0 - rounding * i / (_CONTACTS - 1.0))
        read = y[0] - place * half
        for k in range(y.size):
            read = min(max(read, y[k] - half), y[k] + half)
            result[k] += read / _CONTACTS
    return result


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Drag the reading along by either end of a gap, within which it stands still.

    With ``rounding`` the contacts close one after the other, from 1 - ``rounding`` of the gap on.
    ``place`` is where the output stands in the gap at the first sample: 1 at the end that drags the
    reading up, -1 at the other.
    """
    gap, rounding, place = q
    result: np.ndarray = _read(y, gap, rounding, place)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the gap between both ends, the rounding of its corners, and the place at the start."""
    span, unit = scales.y_span, scales.y_unit
    return (
        Parameter("gap", unit, 0.1 * span, 1.5, 1e-4 * span, 0.8 * span, log=True),
        Parameter("rounding", "1", 0.0, 0.2, 0.0, 0.8, shape=True),
        Parameter("place", "1", 0.0, 0.5, -1.0, 1.0, at_start=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a narrow and a wide gap, from either end and the middle."""
    return tuple(
        (part * scales.y_span, 0.0, place) for part in (0.03, 0.15) for place in (-0.9, 0.0, 0.9)
    )


EFFECT = Effect(
    name="backlash",
    port=Port.OUTPUT,
    family=Family.DISSIPATION,
    symptom="after each reversal the reading stands still for the same distance, at any rate",
    citation="Tao and Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor "
    "Nonlinearities, on backlash at the output; Nordin and Gutman (2002), Automatica 38:1633; "
    "Krasnosel'skii and Pokrovskii (1989), Systems with Hysteresis, on several plays",
    parameters=parameters,
    starts=starts,
    shape_output=law,
    remembers_motion=True,
)
