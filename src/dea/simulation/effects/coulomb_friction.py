"""Dry friction: a force that opposes the motion and holds the device still."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Elasto-plastic contact: its deflection is ``memory[0]``, the last position ``memory[1]``."""
    deflection = min(max((memory[0] + z - memory[1]) / q[1], -1.0), 1.0)
    excess = q[2] / (1.0 + (w / q[3]) ** 2)
    return float(-q[0] * deflection * (1.0 + excess))


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Slip where the deflection has reached its limit."""
    memory[0] = min(max(memory[0] + z_next - memory[1], -q[1]), q[1])
    memory[1] = z_next


def memory(q: np.ndarray) -> np.ndarray:
    """Return a contact without force at the rest position."""
    state = np.zeros(MEMORY)
    state[1] = q[4]
    return state


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the force, deflection before slip, excess of stiction, Stribeck rate, and rest."""
    span = scales.z_span
    return (
        Parameter("force", "1", 0.05 * span, 1.5, 1e-5, 10.0, log=True),
        Parameter(
            "slip_deflection", "1", 0.01 * span, 1.0, 5e-4 * span, 0.05 * span, log=True, shape=True
        ),
        Parameter("stiction_excess", "1", 0.0, 0.2, 0.0, 2.0, shape=True),
        Parameter(
            "stribeck_rate", "1/s", 0.1 * span, 1.0, 1e-3 * span, 10.0 * span, log=True, shape=True
        ),
        Parameter("rest_position", "1", 0.0, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return weak to strong friction, with a soft and a hard contact."""
    span = scales.z_span
    return tuple(
        (part * span, slip * span, 0.0, 0.1 * span, 0.0)
        for part in (0.02, 0.08, 0.2)
        for slip in (0.015, 0.002)
    )


EFFECT = Effect(
    name="coulomb_friction",
    port=Port.FORCE,
    family=Family.DISSIPATION,
    symptom="at each reversal the device stands still until the drive has changed enough",
    citation="Dupont et al. (2002), IEEE Transactions on Automatic Control 47:787, elasto-plastic "
    "friction",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    uses_position=False,
    refine=2,
)
