"""A second mass is coupled to the first by a spring and a dashpot."""

import numpy as np
from numba import float64, njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE, VECTOR

_TWO_PI = 2.0 * np.pi
# Damping ratio, 1/√2, from which a mode has no resonance: what relaxes without one is creep.
_NO_PEAK = 0.7
# Whether the second mass moves by itself. If no spring holds the first mass, the second one starts
# at its position with its speed, which are known after the first step.
_APART, _TOGETHER = 0.0, 1.0


@njit(float64(VECTOR), cache=True, error_model="numpy")
def _unit(q: np.ndarray) -> float:
    """Return the unit of the stiffness, and the inverse of that of the stretch.

    They are those of the elastic force. Where there is none, the stiffness of a spring that gives
    the first mass the frequency of the second one, so that the coupling is the ratio of the masses.
    """
    return 1.0 if q[7] == 0.0 else (_TWO_PI * q[1]) ** 2 * q[7]


@njit(float64(float64, VECTOR), cache=True, error_model="numpy")
def _spring(stretch: float, q: np.ndarray) -> float:
    """Return the factor on the spring's stiffness: it hardens, and differs between its sides."""
    side = q[6] if stretch > 0.0 else -q[6]
    stretch *= _unit(q)
    return float(np.exp(side) * (1.0 + q[4] * stretch * stretch))


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Hardening spring and dashpot to the second mass: ``memory`` begins with its motion."""
    together = memory[3] == _TOGETHER
    stretch = -memory[4] if together else z - memory[0]
    beside = 0.0 if together else w - memory[1]
    spring = _spring(stretch, q)
    loss = 2.0 * q[2] * (1.0 - q[5]) / (_TWO_PI * q[1])
    return float(-q[0] * _unit(q) * (stretch * spring + loss * beside))


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Integrate the motion of the second mass by the trapezoidal rule.

    A part of the damping is to the ground, and the rest to the first mass.
    """
    omega, damping = _TWO_PI * q[1], 2.0 * q[2] * _TWO_PI * q[1]
    half = 0.5 * h
    # The memory is half a step ahead: its step has ``z_next`` in its middle. The first mass' speed
    # there is extrapolated from its means over the last two steps. What the first of them misses
    # because the motion before it is unknown, the next one makes up for.
    mean = (z_next - z) / h
    if memory[3] == _TOGETHER:
        if z_next == z:
            return
        # The memory is in the middle of the step.
        memory[0], memory[1], memory[2] = 0.5 * (z + z_next) + memory[4], mean, mean
        memory[3] = _APART
    a, v = memory[0], memory[1]
    w = 1.5 * mean - 0.5 * memory[2]
    # Only the linear part is implicit: the stiffness is that at the stretch expected.
    stretch = z_next - a - half * v
    square = omega * omega * _spring(stretch, q)
    pull = square * stretch + damping * ((1.0 - q[5]) * w - v)
    v_next = v + h * pull / (1.0 + half * damping + half * half * square)
    memory[0] = a + half * (v + v_next)
    memory[1] = v_next
    memory[2] = mean


def memory(q: np.ndarray) -> np.ndarray:
    """Return a second mass at rest, or that moves with a first one which no spring holds."""
    state = np.zeros(MEMORY)
    if q[7] == 0.0:
        state[0] = q[3]
    else:
        state[3], state[4] = _TOGETHER, q[3] / _unit(q)
    return state


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return coupling, frequency, damping and start of the second mass, and the hardening.

    And the part of the damping that is to the ground, how the spring's sides differ, and the
    inertia of a first mass that no elastic force holds. Such a mass wanders: the start is then
    relative to it, and the stretch in units of what its unit of force stretches at the frequency.
    """
    nyquist = 0.5 / scales.interval
    middle, span = _start(scales), 1.0 if scales.inertia else scales.z_span
    return (
        Parameter("coupling", "1", 0.1, 1.5, 1e-4, 5.0, log=True),
        Parameter("frequency", "Hz", 0.1 * nyquist, 1.0, 1e-3 * nyquist, nyquist, log=True),
        Parameter("damping_ratio", "1", 0.05, 1.0, 2e-3, _NO_PEAK, log=True),
        Parameter("start_position", "1", middle, span, at_start=True),
        Parameter("hardening", "1", 0.0, 0.3 / span**2, 0.0, 10.0 / span**2, shape=True),
        Parameter("grounded_damping", "1", 0.0, 0.3, 0.0, 1.0, shape=True),
        Parameter("asymmetry", "1", 0.0, 0.3, -1.5, 1.5, shape=True),
        Parameter("inertia", "s^2", scales.inertia, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return second masses at the frequencies at which the residual peaks, and from slow to fast.

    They are light and well damped, which widens the band from which a fit finds the frequency.
    """
    nyquist, middle = 0.5 / scales.interval, _start(scales)
    grid = [part * nyquist for part in (0.02, 0.05, 0.1, 0.3)]
    lines = [line for line in scales.frequencies if 1e-3 * nyquist < line < nyquist]
    shapes = (0.0, 0.0, 0.0, scales.inertia)
    return tuple((0.05, frequency, 0.15, middle, *shapes) for frequency in (*lines, *grid))


def _start(scales: Scales) -> float:
    return 0.0 if scales.inertia else scales.z_middle


EFFECT = Effect(
    name="second_mode",
    port=Port.FORCE,
    family=Family.OSCILLATION,
    symptom="after a jump, or at one frequency, the device rings where the simulation does not",
    citation="Den Hartog (1956), Mechanical Vibrations, chapter 3, on the dynamic absorber; "
    "Chu and Shen (1992), AIAA Journal 30:2512, on a spring with unlike sides",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    needs_position=False,
    refine=2,
    defining="frequency",
)
