"""The material creeps under a constant load."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE

BRANCHES = 5
SPACING = 5.0


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Elastic force of the Maxwell branches, whose dashpots stand at ``memory``."""
    total, stiffness = 0.0, q[0]
    for i in range(BRANCHES):
        total -= stiffness * (z - memory[i])
        stiffness *= q[2]
    return total


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Relax each dashpot towards the position in the middle of its own step, exactly."""
    tau = q[1]
    for i in range(BRANCHES):
        memory[i] += (z_next - memory[i]) * (1.0 - np.exp(-h / tau))
        tau *= SPACING


def memory(q: np.ndarray) -> np.ndarray:
    """Return the dashpots at the start; slow ones may be further from equilibrium."""
    state = np.zeros(MEMORY)
    state[:BRANCHES] = np.linspace(q[3], q[4], BRANCHES)
    return state


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return stiffness and time of the fastest branch, ratio of the next ones, and both starts."""
    dt, middle = scales.interval, 0.5 * (scales.z_low + scales.z_high)
    return (
        Parameter("stiffness", "1", 0.1, 1.5, 1e-4, 10.0, log=True),
        Parameter("fastest_time", "s", 20 * dt, 2.0, 2 * dt, scales.duration, log=True),
        Parameter("branch_ratio", "1", 0.7, 0.5, 0.01, 3.0, log=True, shape=True),
        Parameter("start_position", "1", middle, max(scales.z_span, 0.5), at_start=True),
        Parameter("slow.start_position", "1", middle, max(scales.z_span, 0.5), at_start=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return creep of different speeds, from rest and from the middle of the motion."""
    low, middle = scales.z_low, 0.5 * (scales.z_low + scales.z_high)
    return (
        (0.1, 10 * scales.interval, 0.7, low, low),
        (0.1, 50 * scales.interval, 0.5, middle, middle),
        (0.1, 0.03 * scales.duration, 0.3, low, low),
        (0.1, 5 * scales.interval, 0.1, middle, middle),
    )


EFFECT = Effect(
    name="viscoelastic_creep",
    port=Port.FORCE,
    family=Family.RELAXATION,
    symptom="under a held load the device goes on moving the same way, and remembers it",
    citation="Hong (2011), Journal of the Mechanics and Physics of Solids 59:637, on "
    "viscoelastic dielectric elastomers",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
)
