"""The material softens with each cycle, and below the largest stroke that it has made."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Part of the elastic force that damage removes.

    ``memory`` holds the travel, the largest stretch so far, and the damage by the travel. Below
    that stretch the material is the softer the more energy it lacks. At it, only the part
    ``regained`` has its force again.
    """
    stretch = z - q[6]
    largest = max(memory[1], abs(stretch))
    lost = np.tanh((largest * largest - q[5] * stretch * stretch) / (q[4] * q[4]))
    return float(q[0] * memory[2] * z + q[3] * lost * stretch)


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Add up the travel, which damages, and keep the largest stretch."""
    memory[0] += abs(z_next - z)
    memory[1] = max(memory[1], abs(z_next - q[6]))
    memory[2] = 1.0 - np.exp(-((memory[0] / q[1]) ** q[2]))


def memory(q: np.ndarray) -> np.ndarray:
    """Return a material that has not moved."""
    return np.zeros(MEMORY)


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the softening by travel in the long run, the travel it takes, and its exponent.

    Then that by the largest stroke, the stroke it takes, the part of it that is regained at the
    largest stroke, and where the material is not stretched.
    """
    low, high, span = scales.z_low, scales.z_high, scales.z_span
    travel = span * max(scales.duration, 1.0)
    return (
        Parameter("softening", "1", 0.1, 1.5, 1e-4, 0.9, log=True),
        Parameter(
            "travel", "1", 0.3 * travel, 2.0, 1e-3 * travel, 1e2 * travel, log=True,
            at_port="length",
        ),
        Parameter("exponent", "1", 1.0, 0.3, 0.2, 4.0, log=True, shape=True),
        Parameter("stroke_softening", "1", 0.0, 0.3, 0.0, 0.9),
        Parameter(
            "stroke", "1", 0.5 * span, 1.0, 0.01 * span, 5.0 * span, log=True, shape=True,
            at_port="length",
        ),
        Parameter("regained", "1", 1.0, 0.3, 0.0, 1.0, shape=True),
        Parameter(
            "unstretched", "1", 0.0, 0.5 * span + abs(low), min(low, 0.0) - 2.0 * span,
            max(high, 0.0), shape=True,
        ),
    )  # fmt: skip


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return softening by travel that settles early, late, and not within the record.

    And such by the stroke, soon and late, measured from rest and from the bottom of the motion.
    """
    span, travel = scales.z_span, scales.z_span * scales.duration
    return (
        *((0.1, part * travel, 0.8, 0.0, 0.5 * span, 1.0, 0.0) for part in (0.03, 0.2, 1.0)),
        *(
            (0.01, 0.2 * travel, 0.8, 0.2, part * span, 1.0, bottom)
            for part in (0.2, 0.7)
            for bottom in (0.0, scales.z_low)
        ),
    )


EFFECT = Effect(
    name="cyclic_softening",
    port=Port.FORCE,
    family=Family.AGEING,
    symptom="the device gives way more with every cycle, or below its largest stroke, and not "
    "while it rests",
    citation="Miehe (1995), European Journal of Mechanics A/Solids 14:697, on damage by travel; "
    "Ogden and Roxburgh (1999), Proceedings of the Royal Society A 455:2861, and Dorfmann and "
    "Ogden (2003), International Journal of Solids and Structures 40:2699, on that by the largest "
    "stroke",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    remembers_motion=True,
    defining="softening",
)
