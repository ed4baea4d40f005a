"""The material creeps under a constant load.

Maxwell branches in parallel, at times in equal ratios over all that the record can tell, each with
a stiffness of its own (a Prony series). A function of the position stretches them, as in
quasi-linear viscoelasticity (Fung 1981, Biomechanics, section 7.6), another one multiplies their
force. The dashpots may flow faster or slower the larger the stress (Norton 1929, The Creep of
Steel at High Temperatures).
"""

import numpy as np
from numba import float64, njit

from dea.simulation.effects._effect import Effect, Family, Port, Quantity
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE, VECTOR

BRANCHES = 8
# The fastest branch relaxes in so many samples, the slowest in so many records.
_FASTEST, _SLOWEST = 2.0, 2.0
# Where a position counts as this many half ranges from the middle, the law goes on as there.
_FARTHEST = 5.0
# Places in the parameters: of the deviation of the first branch's stiffness, and of what follows.
_OWN = 2
(
    _START, _STRETCH, _AGE, _TILT, _CURVE, _RATE, _RATE_STRETCH, _RESPONSE, _FIRST, _RATIO, _MIDDLE,
    _HALF,
) = range(_OWN + BRANCHES, _OWN + BRANCHES + 12)  # fmt: skip
# Places in the memory behind the dashpots: the stiffnesses of the branches, the parts by which they
# relax in a step, the sum of the stiffnesses and that of the dashpots times them, the step.
_STIFFNESS, _PART = BRANCHES, 2 * BRANCHES
_SUM, _PULL, _STEP = range(3 * BRANCHES, 3 * BRANCHES + 3)


@njit(float64(float64, VECTOR), cache=True, error_model="numpy")
def _place(z: float, q: np.ndarray) -> float:
    return float(min(max((z - q[_MIDDLE]) / q[_HALF], -_FARTHEST), _FARTHEST))


@njit(float64(float64, VECTOR), cache=True, error_model="numpy")
def _strain(place: float, q: np.ndarray) -> float:
    """Return what the branches are stretched by at a place: its slope changes along the range."""
    return float(q[_RESPONSE] * (place + q[_CURVE] * place * place / (1.0 + abs(place))))


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Force of the Maxwell branches, whose dashpots stand at the first of ``memory``."""
    place = _place(z, q)
    stress = memory[_SUM] * _strain(place, q) - memory[_PULL]
    tilted = q[_TILT] * place
    return float(-q[_HALF] * (tilted + np.sqrt(1.0 + tilted * tilted)) * stress)


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Relax each dashpot towards the position in the middle of its own step, exactly.

    Its rate is that of the stress at the step's start.
    """
    if h != memory[_STEP]:
        memory[_STEP], tau = h, q[_FIRST]
        for i in range(BRANCHES):
            memory[_PART + i] = -np.expm1(-h / tau)
            tau *= q[_RATIO]
    strain, pull = _strain(_place(z_next, q), q), 0.0
    linear, tau = q[_RATE] == 0.0, q[_FIRST]
    if not linear:
        stretch = (strain - memory[_PULL] / memory[_SUM]) / q[_RATE_STRETCH]
        tau /= (1.0 + stretch * stretch) ** q[_RATE]
    for i in range(BRANCHES):
        part = memory[_PART + i] if linear else -np.expm1(-h / tau)
        memory[i] += (strain - memory[i]) * part
        pull += memory[_STIFFNESS + i] * memory[i]
        tau *= q[_RATIO]
    memory[_PULL] = pull


def _spectrum(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the relaxation times of the branches, and their stiffnesses."""
    branch = np.arange(BRANCHES)
    return q[_FIRST] * q[_RATIO] ** branch, q[0] * q[1] ** branch * np.exp(q[_OWN:_START])


def relaxed(q: np.ndarray, times: np.ndarray | float, scales: Scales) -> np.ndarray:
    """Return the stiffness that relaxes up to ``times`` (any shape) after a step.

    What has relaxed until the motion could have crossed its range does not count: in this record it
    is a damping.
    """
    tau, stiffness = _spectrum(q)
    first, later = scales.crossing, np.maximum(times, scales.crossing)
    found: np.ndarray = (np.exp(-first / tau) - np.exp(-np.divide.outer(later, tau))) @ stiffness
    return found


def _relaxing(q: np.ndarray, scales: Scales) -> float:
    """Return the stiffness that relaxes within the record."""
    return float(relaxed(q, scales.duration, scales))


def _half_time(q: np.ndarray, scales: Scales) -> float:
    """Return the time after a step at which half of that stiffness has relaxed."""
    from scipy.optimize import brentq

    half = 0.5 * _relaxing(q, scales)

    def beyond_half(time: float) -> float:
        return float(relaxed(q, time, scales)) - half

    return float(brentq(beyond_half, scales.crossing, scales.duration))


def memory(q: np.ndarray) -> np.ndarray:
    """Return the dashpots at the start: how far each has followed a stretch of a certain age."""
    tau, stiffness = _spectrum(q)
    dashpots = q[_START] - q[_STRETCH] * np.exp(-q[_AGE] / tau)
    state = np.zeros(MEMORY)
    state[:BRANCHES], state[_STIFFNESS:_PART] = dashpots, stiffness
    state[_SUM], state[_PULL] = stiffness.sum(), stiffness @ dashpots
    return state


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return stiffnesses of the branches, the film's history, the law's shape, and the times.

    At a mean stretch of the springs of ``rate_stretch`` half ranges the dashpots flow 2 to the
    power of ``rate_exponent`` times as fast as without stress. Where the branches do not respond to
    the motion, what they were stretched by before relaxes, and the law is a force that drifts.
    """
    first, ratio = _times(scales)
    duration = scales.duration
    return (
        Parameter("stiffness", "1", 0.05, 1.5, 1e-5, 10.0, log=True, at_port="stiffness"),
        Parameter("branch_ratio", "1", 0.9, 0.3, 0.1, 3.0, log=True),
        *(
            Parameter(f"branch_{n}", "1", 0.0, 1.0, -6.0, 6.0, shape=True)
            for n in range(1, BRANCHES + 1)
        ),
        Parameter("start_position", "1", 0.0, 1.0, at_start=True),
        Parameter("stretch", "1", 0.0, 4.0, at_start=True),
        Parameter("age", "s", 0.1 * duration, 2.0, first, 1e3 * duration, log=True, at_start=True),
        Parameter("tilt", "1", 0.0, 0.5, -3.0, 3.0, shape=True),
        Parameter("curve", "1", 0.0, 0.4, -0.95, 0.95, shape=True),
        Parameter("rate_exponent", "1", 0.0, 0.5, -1.0, 3.0, shape=True),
        Parameter("rate_stretch", "1", 0.2, 1.0, 0.01, 5.0, log=True, shape=True),
        Parameter("response", "1", 1.0, 0.0, 0.0, 1.0),
        Parameter("fastest_time", "s", first, 0.0),
        Parameter("time_ratio", "1", ratio, 0.0),
        Parameter("middle", "1", scales.z_middle, 0.0),
        Parameter("half_range", "1", 0.5 * scales.z_span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return creep over all times, mostly slow and mostly fast, from the middle and from rest."""
    first, ratio = _times(scales)
    branch = np.arange(BRANCHES)
    middle, half = scales.z_middle, 0.5 * scales.z_span
    end = (0.1 * scales.duration, 0.0, 0.0, 0.0, 0.2, 1.0, first, ratio, middle, half)
    return tuple(
        (0.05, 0.9, *(1.0 - ((branch - strongest) / 4.0) ** 2), position, 0.0, *end)
        for strongest, position in ((3.5, 0.0), (3.5, -1.0), (6.5, 0.0), (0.5, 0.0))
    )


def _times(scales: Scales) -> tuple[float, float]:
    """Return the time of the fastest branch, and the ratio of each next one's to it."""
    first = _FASTEST * scales.interval
    return first, float((_SLOWEST * scales.duration / first) ** (1.0 / (BRANCHES - 1)))


EFFECT = Effect(
    name="viscoelastic_creep",
    port=Port.FORCE,
    family=Family.RELAXATION,
    symptom="under a held load the device goes on moving the same way, and remembers it",
    citation="Guo, Xiao, Park and Nguyen (2015), Journal of Applied Mechanics 82:091009, on the "
    "relaxation spectrum of VHB 4905",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    essential="response",
    defining="stiffness",
    quantities=(
        Quantity("relaxing_stiffness", "stiffness", _relaxing),
        Quantity("half_time", "fastest_time", _half_time),
    ),
    relaxed=relaxed,
)
