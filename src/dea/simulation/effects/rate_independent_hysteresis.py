"""The force differs between loading and unloading, independently of the rate."""

import numpy as np
from numba import float64, int64, njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE, VECTOR

OPERATORS = 11
# Place in the memory of the weights of the stops.
_WEIGHTS = OPERATORS + 2


@njit(float64(float64, VECTOR), cache=True, error_model="numpy")
def _growth(z: float, q: np.ndarray) -> float:
    """Return the factor on the stop operators at a position: larger at one end, or at both.

    Or smaller at both, where the material saturates. Where it would be negative there are no loops:
    a force of the wrong sign would drive the motion.
    """
    place = min(max((z - q[7]) / q[8], -2.0), 2.0)
    if q[5] < 0.0:
        return float(max(1.0 + q[4] * place, 0.0) / (1.0 - q[5] * place * place))
    return float(max(1.0 + q[4] * place + q[5] * place * place, 0.0))


@njit(float64(int64, VECTOR), cache=True, error_model="numpy")
def _radius(i: int, q: np.ndarray) -> float:
    return float(q[1] * ((i + 1.0) / OPERATORS) ** 2)


@njit(float64(int64, VECTOR), cache=True, error_model="numpy")
def _weight(i: int, q: np.ndarray) -> float:
    return float((i + 1.0) * np.exp(-q[2] * (i + 1.0) / OPERATORS))


@njit(float64(float64, float64, VECTOR), cache=True, error_model="numpy")
def _turned(part: float, way: float, q: np.ndarray) -> float:
    """Return the part of its limit that Duhem's force has after a way."""
    end = 1.0 if way > 0.0 else -1.0
    return float(end + (part - end) * np.exp(-abs(way) / q[1]))


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Stop operators and a force of Duhem's type, in parallel.

    ``memory`` holds the forces of the stops, the last position, the part of its limit that the
    other force has, and the weights of the stops. With ``skew`` each resists more at its upper
    limit than at its lower one, so that the loop has unlike branches.
    """
    total = 0.0
    growth = _growth(z, q)
    way = z - memory[OPERATORS]
    gained = growth * way
    for i in range(OPERATORS):
        limit = growth * _radius(i, q)
        weight = memory[_WEIGHTS + i]
        stop = min(max(memory[i] + gained, -limit), limit)
        share = stop / limit if limit != 0.0 else 0.0
        total -= weight * stop * (1.0 + q[6] * share)
    turned = _turned(memory[OPERATORS + 1], way, q)
    duhem = growth * q[1] * turned * (1.0 + q[6] * turned)
    return float(q[0] * ((1.0 - q[9]) * total / OPERATORS - q[9] * duhem))


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Move each stop, which slips at its radius, and turn the other force."""
    growth = _growth(z_next, q)
    way = z_next - memory[OPERATORS]
    gained = growth * way
    for i in range(OPERATORS):
        limit = growth * _radius(i, q)
        memory[i] = min(max(memory[i] + gained, -limit), limit)
    memory[OPERATORS + 1] = _turned(memory[OPERATORS + 1], way, q)
    memory[OPERATORS] = z_next


def memory(q: np.ndarray) -> np.ndarray:
    """Return no force at the start position."""
    state = np.zeros(MEMORY)
    state[OPERATORS] = q[3]
    state[_WEIGHTS : _WEIGHTS + OPERATORS] = [_weight(i, q) for i in range(OPERATORS)]
    return state


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return stiffness, radius, decay of the weight with it, start, growth in space, and skew.

    And the part of the stiffness that is of Duhem's type.
    """
    span, middle = scales.z_span, scales.z_middle
    return (
        Parameter("stiffness", "1", 0.2, 1.5, 1e-4, 100.0, log=True, at_port="stiffness"),
        Parameter(
            "largest_radius",
            "1",
            0.5 * span,
            1.0,
            0.02 * span,
            5 * span,
            log=True,
            at_port="length",
        ),
        Parameter("weight_decay", "1", 2.0, 2.0, -3.0, 20.0, shape=True),
        Parameter("start_position", "1", middle, 0.5 * span, at_start=True),
        Parameter("tilt", "1", 0.0, 0.3, -1.0, 1.0, shape=True),
        Parameter("growth_at_ends", "1", 0.0, 0.3, -5.0, 5.0, shape=True),
        Parameter("skew", "1", 0.0, 0.3, -0.5, 0.5, shape=True),
        Parameter("middle", "1", middle, 0.0),
        Parameter("half_range", "1", 0.5 * span, 0.0),
        Parameter("duhem_part", "1", 0.0, 0.3, 0.0, 1.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return loops narrower and wider than the motion, that saturate at both ends, and Duhem's."""
    span, middle = scales.z_span, scales.z_middle
    stops = ((0.2, 0.0), (0.6, 0.0), (1.5, 0.0), (0.2, -2.0), (0.6, -2.0))
    loops = (*((*each, 0.0) for each in stops), (0.2, 0.0, 1.0), (0.6, 0.0, 1.0))
    return tuple(
        (0.2, part * span, 2.0, middle, 0.0, growth, 0.0, middle, 0.5 * span, duhem)
        for part, growth, duhem in loops
    )


EFFECT = Effect(
    name="rate_independent_hysteresis",
    port=Port.FORCE,
    family=Family.DISSIPATION,
    symptom="up and down differ by a loop that does not shrink when the motion is slow",
    citation="Visintin (1994), Differential Models of Hysteresis, III (Prandtl-Ishlinskii) and V "
    "(Duhem), with unlike branches as in Al Janaideh, Rakheja and Su (2011)",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    remembers_motion=True,
    defining="stiffness",
)
