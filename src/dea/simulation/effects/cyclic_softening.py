"""The material softens with each cycle."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Part of the elastic force that damage removes; ``memory[0]`` is the travel."""
    damage = 1.0 - np.exp(-((memory[0] / q[1]) ** q[2]))
    return float(q[0] * damage * z)


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Add up the travel."""
    memory[0] += abs(z_next - z)


def memory(q: np.ndarray) -> np.ndarray:
    """Return a material that has not moved."""
    return np.zeros(MEMORY)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the softening in the long run, the travel it takes, and its exponent."""
    travel = scales.z_span * max(scales.duration, 1.0)
    return (
        Parameter("softening", "1", 0.1, 1.5, 1e-4, 0.9, log=True),
        Parameter("travel", "1", 0.3 * travel, 2.0, 1e-3 * travel, 1e2 * travel, log=True),
        Parameter("exponent", "1", 1.0, 0.3, 0.2, 2.0, log=True, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return softening that settles early, late, and not within the record."""
    travel = scales.z_span * scales.duration
    return tuple((0.1, part * travel, 0.8) for part in (0.03, 0.2, 1.0))


EFFECT = Effect(
    name="cyclic_softening",
    port=Port.FORCE,
    family=Family.AGEING,
    symptom="the device gives way more with every cycle, and not while it rests",
    citation="Mullins (1969), Rubber Chemistry and Technology 42:339",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
)
