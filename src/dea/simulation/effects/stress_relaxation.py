"""The material's stress relaxes with time, whether it moves or not."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Part of the elastic force, and of the prestress, that is lost: ``memory[1]``, by the time."""
    return float(memory[1] * (q[0] * z + q[3]))


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Let the time pass."""
    memory[0] += h
    memory[1] = 1.0 - np.exp(-((memory[0] / q[1]) ** q[2]))


def memory(q: np.ndarray) -> np.ndarray:
    """Return a material that is stressed from the start of the run, which the lead-in begins."""
    return np.zeros(MEMORY)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the elastic force lost in the long run, its time and exponent, the prestress lost."""
    dt, duration = scales.interval, scales.duration
    return (
        Parameter("relaxation", "1", 0.1, 1.5, 1e-4, 0.9, log=True),
        Parameter("time", "s", 0.3 * duration, 2.0, 5 * dt, 1e2 * duration, log=True),
        Parameter("exponent", "1", 0.8, 0.4, 0.1, 4.0, log=True, shape=True),
        Parameter("prestress", "1", 0.0, 0.1, -2.0, 2.0, at_port="force"),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return relaxation that ends early, late, not within the record, and that sets in late."""
    return tuple(
        (0.1, part * scales.duration, exponent, 0.0)
        for part, exponent in ((0.03, 0.8), (0.2, 0.8), (1.0, 0.8), (0.5, 2.5))
    )


EFFECT = Effect(
    name="stress_relaxation",
    port=Port.FORCE,
    family=Family.AGEING,
    symptom="the device gives way more with time, also while it rests",
    citation="Kohlrausch (1854), Annalen der Physik 91:56, on stretched exponentials; Avrami "
    "(1939), Journal of Chemical Physics 7:1103, on changes that set in",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    transferable=False,
    # Without it a force drifts, whatever the stress.
    essential="relaxation",
    defining="relaxation",
)
