"""The motion is limited by a stop."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import knee
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Stiff contact beyond the upper stop, or the lower one, with a soft corner."""
    upper, lower = knee(z - q[0], q[3]), knee(q[1] - z, q[3])
    return float(q[2] * ((lower / q[5]) ** q[4] - (upper / q[5]) ** q[4]) * q[5])


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return upper and lower stop, stiffness, corner width and exponent of the contact."""
    span = scales.z_span
    return (
        Parameter("upper_stop", "1", scales.z_high - 0.1 * span, 0.3 * span),
        Parameter("lower_stop", "1", scales.z_low - 0.2 * span, 0.3 * span),
        Parameter("stiffness", "1", 5.0, 1.0, 1.0, 300.0, log=True),
        Parameter(
            "corner_width", "1", 0.01 * span, 1.0, 1e-3 * span, 0.1 * span, log=True, shape=True
        ),
        Parameter("exponent", "1", 1.0, 0.3, 1.0, 2.0, log=True, shape=True),
        Parameter("reference", "1", 0.1 * span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a stop near the upper end, deeper in, and at the lower end."""
    low, high, span = scales.z_low, scales.z_high, scales.z_span
    return (
        (high - 0.1 * span, low - 0.3 * span, 5.0, 0.02 * span, 1.0, 0.1 * span),
        (high - 0.3 * span, low - 0.3 * span, 5.0, 0.02 * span, 1.0, 0.1 * span),
        (high - 0.5 * span, low - 0.3 * span, 5.0, 0.02 * span, 1.0, 0.1 * span),
        (high + 0.3 * span, low + 0.1 * span, 5.0, 0.02 * span, 1.0, 0.1 * span),
    )


EFFECT = Effect(
    name="end_stop",
    port=Port.FORCE,
    family=Family.LIMIT,
    symptom="beyond a position the device stands still while the drive goes on",
    citation="Brogliato (2016), Nonsmooth Mechanics, chapter 2, compliant contact",
    parameters=parameters,
    starts=starts,
    force=force,
    refine=2,
)
