"""The motion is limited by a stop."""

import numpy as np
from numba import float64, njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import knee
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, VECTOR


@njit(float64(float64, float64, VECTOR), cache=True, error_model="numpy")
def _contact(depth: float, rate: float, q: np.ndarray) -> float:
    """Return the push of a contact at a depth of penetration and its rate; it never pulls."""
    if depth <= 0.0:
        return 0.0
    part = depth / q[5]
    return max(float(part ** q[4] + q[6] * rate * part ** (q[4] - q[7])), 0.0)


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Stiff, damped contact beyond the upper stop, or the lower one, with a soft corner.

    Its damping grows with a power of the depth: with the force at onset 0, and at onset 1 with its
    exponent less one, not at all where the force is linear.
    """
    upper, lower = knee(z - q[0], q[3]), knee(q[1] - z, q[3])
    return float(q[2] * q[5] * (_contact(lower, -w, q) - _contact(upper, w, q)))


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return upper and lower stop, and the contact's stiffness, corner width and exponent.

    Then its damping, and how soon that is there.
    """
    span = scales.z_span
    return (
        Parameter("upper_stop", "1", scales.z_high - 0.1 * span, 0.3 * span, at_port="place"),
        Parameter("lower_stop", "1", scales.z_low - 0.2 * span, 0.3 * span, at_port="place"),
        Parameter("stiffness", "1", 5.0, 1.0, 1.0, 300.0, log=True, at_port="stiffness"),
        Parameter(
            "corner_width",
            "1",
            0.01 * span,
            1.0,
            1e-3 * span,
            0.1 * span,
            log=True,
            shape=True,
            at_port="length",
        ),
        Parameter("exponent", "1", 1.0, 0.3, 1.0, 2.0, log=True, shape=True),
        Parameter("reference", "1", 0.1 * span, 0.0),
        Parameter("damping", "s", 0.0, 0.2, 0.0, 10.0, shape=True),
        Parameter("onset", "1", 0.5, 0.3, 0.0, 1.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a stop near the upper end, deeper in, at the lower end, and at both."""
    low, high, span = scales.z_low, scales.z_high, scales.z_span
    contact = (5.0, 0.02 * span, 1.0, 0.1 * span, 0.0, 0.5)
    return (
        *((high - part * span, low - 0.3 * span, *contact) for part in (0.1, 0.3, 0.5)),
        (high + 0.3 * span, low + 0.1 * span, *contact),
        (high - 0.1 * span, low + 0.1 * span, *contact),
    )


EFFECT = Effect(
    name="end_stop",
    port=Port.FORCE,
    family=Family.LIMIT,
    symptom="beyond a position the device stands still while the drive goes on",
    citation="Brogliato (2016), Nonsmooth Mechanics, chapter 2, compliant contact; Hunt and "
    "Crossley (1975), Journal of Applied Mechanics 42:440, on its damping",
    parameters=parameters,
    starts=starts,
    force=force,
    refine=2,
)
