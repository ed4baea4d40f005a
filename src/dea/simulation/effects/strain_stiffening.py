"""The material stiffens (or softens) with strain more than the simulation says."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Power law of the deflection from rest, with even and cubic parts beside it."""
    size = abs(z)
    return float(-q[0] * z * size ** (q[1] - 1.0) - (q[2] + q[3] * z) * size * size)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the stiffening at full deflection, its exponent, the even and the cubic part."""
    return (
        Parameter("stiffening", "1", 0.0, 0.3, -1.0, 50.0),
        Parameter("exponent", "1", 5.0, 0.4, 1.5, 15.0, log=True, shape=True),
        Parameter("even_part", "1", 0.0, 0.1, -5.0, 5.0),
        Parameter("cubic_part", "1", 0.0, 0.1, -5.0, 5.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return a weak cubic, a steep law, and a softening."""
    return ((0.05, 3.5, 0.0, 0.05), (0.2, 7.0, 0.0, 0.0), (-0.05, 3.5, 0.0, -0.05))


EFFECT = Effect(
    name="strain_stiffening",
    port=Port.FORCE,
    family=Family.CURVE,
    symptom="large deflections fall short of (or exceed) the simulation, whatever the rate",
    citation="Gent (1996), Rubber Chemistry and Technology 69:59; Duffing (1918) for the cubic",
    parameters=parameters,
    starts=starts,
    force=force,
)
