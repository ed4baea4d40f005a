"""Effects that change a parameter of the actuator while the experiment runs."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant import forces
from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Conditions, EffectKind, Port
from dea.plant.rig import Law
from dea.plant.signal_law import SignalLaw

SATURATING, ROOT, LOGISTIC, SWELL = range(4)


@njit(cache=True)
def _course(shape: float, place: float, t: float) -> float:
    """A change from 0 to about 1 over time ``t``; ``place`` is its time constant or middle."""
    value: float = np.sin(0.5 * np.pi * min(t / (2.0 * place), 2.0))
    if shape == SATURATING:
        value = 1.0 - np.exp(-t / place)
    elif shape == ROOT:
        value = np.sqrt(t / (t + place))
    elif shape == LOGISTIC:
        value = 1.0 / (1.0 + np.exp(-(t - place) / (0.25 * place)))
    return value


@njit(cache=True)
def _drifting_gain(c: Array, m: Array, u: Array) -> None:
    """Scale the electrostatic force, which is proportional to the square of the command."""
    for k in range(u.shape[0]):
        u[k] *= np.sqrt(max(1.0 + c[0] * _course(c[1], c[2], m[0] * SUBSTEP), 0.0))
        m[0] += 1.0


def gain_drift(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a gain that rises or falls by a share ``size``, over time as one of four functions."""
    shape = float(rng.integers(4))
    place = rng.uniform(0.25, 0.6) * conditions.duration
    return SignalLaw(_drifting_gain, [size * _sign(size, rng), shape, place])


@njit(cache=True)
def _drifting_offset(c: Array, m: Array, y: Array) -> None:
    for k in range(y.shape[0]):
        y[k] += c[0] * _course(c[1], c[2], m[0] * SUBSTEP)
        m[0] += 1.0


def baseline_drift(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a mount that moves by ``size`` travels, over time as one of four functions."""
    shape = float(rng.integers(4))
    place = rng.uniform(0.25, 0.6) * conditions.duration
    change = size * conditions.travel * rng.choice([-1.0, 1.0])
    return SignalLaw(_drifting_offset, [change, shape, place], output=True)


@njit(cache=True)
def _stepping_gain(c: Array, m: Array, u: Array) -> None:
    for k in range(u.shape[0]):
        share = 1.0 / (1.0 + np.exp(-(m[0] * SUBSTEP - c[1]) / c[2]))
        u[k] *= np.sqrt(max(1.0 + c[0] * share, 0.0))
        m[0] += 1.0


def step_fault(size: float, conditions: Conditions, rng: Generator) -> Law:
    """Hide a sudden change of the gain or the stiffness by a share ``size``.

    It takes 0.02 to 0.15 s, between 30 and 70 % of the experiment.
    """
    time = rng.uniform(0.3, 0.7) * conditions.duration
    rise = rng.uniform(0.02, 0.15)
    change = size * _sign(size, rng)
    if rng.random() < 0.5:
        return SignalLaw(_stepping_gain, [change, time, rise])
    constants = np.array([0.5 * change * conditions.stiffness, time, rise])
    return forces.ForceLaw(forces.STIFFNESS_STEP, constants, np.zeros(1))


def _sign(size: float, rng: Generator) -> float:
    """Down or up; a large change is always up, since a large loss of gain leaves no response."""
    return float(rng.choice([-1.0, 1.0])) if size < 0.5 else 1.0


EFFECTS = (
    EffectKind("gain_drift", Port.TIME, 0.002, 1.0, "1", gain_drift),
    EffectKind("baseline_drift", Port.TIME, 0.005, 2.0, "1", baseline_drift),
    EffectKind("step_fault", Port.TIME, 0.002, 1.0, "1", step_fault),
)
