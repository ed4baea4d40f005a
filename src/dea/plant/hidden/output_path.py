"""Effects between the mass and the reading."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Conditions, EffectKind, Port
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _third_order(c: Array, m: Array, y: Array) -> None:
    """A second-order low-pass (semi-implicit Euler) followed by a first-order one."""
    angular, damping, behind = c
    if m[0] == 0.0:
        m[0], m[1], m[2], m[3] = 1.0, y[0], 0.0, y[0]
    for k in range(y.shape[0]):
        m[2] += SUBSTEP * angular * (angular * (y[k] - m[1]) - 2.0 * damping * m[2])
        m[1] += SUBSTEP * m[2]
        m[3] += SUBSTEP / (behind + SUBSTEP) * (m[1] - m[3])
        y[k] = m[3]


def sensor_lag(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a third-order sensor whose delay at low frequency is ``size`` seconds."""
    damping, behind = rng.uniform(0.5, 1.3), rng.uniform(0.1, 0.4) * size
    constants = [2.0 * damping / (size - behind), damping, behind]
    return SignalLaw(_third_order, constants, np.zeros(4), output=True)


@njit(cache=True)
def _soft_limit(c: Array, m: Array, y: Array) -> None:
    """Limit y from above, with a rounded knee (softplus)."""
    limit, knee = c
    for k in range(y.shape[0]):
        over = (y[k] - limit) / knee
        excess = over + np.log1p(np.exp(-over)) if over > 0.0 else np.log1p(np.exp(over))
        y[k] -= knee * excess


def output_saturation(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a reading that saturates ``size`` of the travel below the top."""
    limit = conditions.top - size * conditions.travel
    knee = rng.uniform(0.005, 0.02) * conditions.travel
    return SignalLaw(_soft_limit, [limit, knee], output=True)


@njit(cache=True)
def _fold(c: Array, m: Array, y: Array) -> None:
    """Reflect the reading at a place, with a rounded corner."""
    place, corner = c
    for k in range(y.shape[0]):
        distance = y[k] - place
        y[k] = place + np.sqrt(distance * distance + corner * corner)


@njit(cache=True)
def _ripple(c: Array, m: Array, y: Array) -> None:
    """A reading error that is periodic in the displacement, as of a detector's pixels."""
    height, period, phase = c
    for k in range(y.shape[0]):
        y[k] += height * np.sin(2.0 * np.pi * y[k] / period + phase)


def sensor_nonlinearity(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a folded or rippled reading: ``size`` is the share folded, or sets the ripple's height.

    The fold reflects readings below a place to above it.
    """
    if rng.random() < 0.5:
        place = conditions.bottom + min(size, 0.7) * conditions.travel
        return SignalLaw(_fold, [place, 0.01 * conditions.travel], output=True)
    height = 0.3 * size * conditions.travel
    period = rng.uniform(0.35, 0.7) * conditions.travel
    return SignalLaw(_ripple, [height, period, rng.uniform(0.0, 2.0 * np.pi)], output=True)


@njit(cache=True)
def _wobble(c: Array, m: Array, y: Array) -> None:
    """Three harmonics whose common phase is slowly modulated."""
    height, frequency, second, third, phase, wander, slow = c
    for k in range(y.shape[0]):
        t = m[0] * SUBSTEP
        angle = 2.0 * np.pi * frequency * t + phase + wander * np.sin(2.0 * np.pi * slow * t)
        wave = np.sin(angle) + second * np.sin(2.0 * angle) + third * np.sin(3.0 * angle)
        y[k] += height * wave
        m[0] += 1.0


def periodic_disturbance(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a vibration of the mount of ``size`` travels, with three harmonics."""
    constants = [
        size * conditions.travel,
        10.0 ** rng.uniform(-0.7, 0.9),
        rng.uniform(0.0, 0.5),
        rng.uniform(0.0, 0.3),
        rng.uniform(0.0, 2.0 * np.pi),
        rng.uniform(0.0, 0.5),
        rng.uniform(0.5, 2.0) / conditions.duration,
    ]
    return SignalLaw(_wobble, constants, output=True)


EFFECTS = (
    EffectKind("sensor_lag", Port.OUTPUT, 0.01, 1.0, "s", sensor_lag),
    EffectKind("output_saturation", Port.OUTPUT, 0.02, 0.7, "1", output_saturation),
    EffectKind("sensor_nonlinearity", Port.OUTPUT, 0.005, 1.0, "1", sensor_nonlinearity),
    EffectKind("periodic_disturbance", Port.OUTPUT, 0.002, 1.0, "1", periodic_disturbance),
)
