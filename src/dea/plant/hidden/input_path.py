"""Effects between the command and the film's electric field."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Conditions, EffectKind, Port
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _soft_threshold(c: Array, m: Array, u: Array) -> None:
    """Zero below the threshold, the excess above it, with a rounded knee (softplus)."""
    threshold, knee, slope = c
    for k in range(u.shape[0]):
        over = (u[k] - threshold) / knee
        soft = over + np.log1p(np.exp(-over)) if over > 0.0 else np.log1p(np.exp(over))
        u[k] = slope * knee * soft


def dead_zone(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a threshold that lies ``size`` of the range above the lowest command.

    The gain above it leaves the highest command unchanged.
    """
    threshold = conditions.low + size * (conditions.high - conditions.low)
    slope = conditions.high / (conditions.high - threshold)
    return SignalLaw(_soft_threshold, [threshold, rng.uniform(0.03, 0.12), slope])


@njit(cache=True)
def _soft_ceiling(c: Array, m: Array, u: Array) -> None:
    """Algebraic sigmoid u / (1 + (u/L)ᵖ)^(1/p)."""
    limit, power = c
    for k in range(u.shape[0]):
        u[k] /= (1.0 + (max(u[k], 0.0) / limit) ** power) ** (1.0 / power)


def input_saturation(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a ceiling that lies ``size`` of the range below the highest command."""
    limit = conditions.high - size * (conditions.high - conditions.low)
    return SignalLaw(_soft_ceiling, [limit, rng.uniform(14.0, 30.0)])


@njit(cache=True)
def _soft_rate(c: Array, m: Array, u: Array) -> None:
    """Follow at a rate that saturates smoothly; rising and falling have limits of their own."""
    rise, fall, quick = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        error = u[k] - m[1]
        limit = rise if error > 0.0 else fall
        m[1] += SUBSTEP * limit * np.tanh(error / (limit * quick))
        u[k] = m[1]


def slew_limit(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide rate limits of about 1/``size`` command ranges per second."""
    rate = (conditions.high - conditions.low) / size
    asymmetry = rng.uniform(0.8, 1.25)
    return SignalLaw(_soft_rate, [rate * asymmetry, rate / asymmetry, 0.004], [0.0, 0.0])


@njit(cache=True)
def _delay_line(c: Array, m: Array, u: Array) -> None:
    """A ring of past values: m holds place, whether the ring is filled, and the ring itself."""
    length = m.shape[0] - 2
    if m[1] == 0.0:
        m[1] = 1.0
        m[2:] = u[0]
    place = int(m[0])
    for k in range(u.shape[0]):
        m[2 + place], u[k] = u[k], m[2 + place]
        place = (place + 1) % length
    m[0] = place


def transport_delay(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a pure delay of ``size`` seconds, to a millisecond."""
    return SignalLaw(_delay_line, [0.0], np.zeros(2 + max(round(size / SUBSTEP), 1)))


@njit(cache=True)
def _ladder(c: Array, m: Array, u: Array) -> None:
    """A distributed resistance and capacitance: diffusion of the voltage along a ladder.

    c holds the share of the difference between neighbours that passes in one internal step, and the
    number of internal steps per sub-step; the film's voltage is the mean over the ladder.
    """
    share, steps = c[0], int(c[1])
    rungs = m.shape[0] - 1
    if m[0] == 0.0:
        m[0] = 1.0
        m[1:] = u[0]
    for k in range(u.shape[0]):
        for _ in range(steps):
            before = u[k]
            for i in range(1, rungs + 1):
                here = m[i]
                after = m[i + 1] if i < rungs else here
                m[i] = here + share * (before - 2.0 * here + after)
                before = here
        u[k] = np.mean(m[1:])


def electrode_lag(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide electrodes along which the voltage diffuses in about ``size`` seconds."""
    rungs = 6
    rate = rungs**2 * SUBSTEP / (3.0 * size)
    steps = int(np.ceil(rate / 0.25))
    return SignalLaw(_ladder, [rate / steps, steps], np.zeros(1 + rungs))


@njit(cache=True)
def _space_charge(c: Array, m: Array, u: Array) -> None:
    """Injected charge screens the field: it follows Poole-Frenkel conduction and leaks away."""
    screening, time, steepness, ceiling = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, 0.0
    for k in range(u.shape[0]):
        field = max(u[k] - m[1], 0.0)
        target = screening * field * np.exp(steepness * (np.sqrt(field / ceiling) - 1.0))
        m[1] += SUBSTEP / time * (target - m[1])
        u[k] = field


def charge_leakage(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide conduction that takes away a share ``size`` of a constant voltage."""
    constants = [size, rng.uniform(1.0, 6.0), rng.uniform(0.3, 1.0), conditions.high]
    return SignalLaw(_space_charge, constants, [0.0, 0.0])


EFFECTS = (
    EffectKind("dead_zone", Port.INPUT, 0.04, 0.5, "1", dead_zone),
    EffectKind("input_saturation", Port.INPUT, 0.02, 0.45, "1", input_saturation),
    EffectKind("slew_limit", Port.INPUT, 0.05, 6.0, "s", slew_limit),
    EffectKind("transport_delay", Port.INPUT, 0.004, 0.6, "s", transport_delay),
    EffectKind("electrode_lag", Port.INPUT, 0.01, 1.0, "s", electrode_lag),
    EffectKind("charge_leakage", Port.INPUT, 0.005, 0.6, "1", charge_leakage),
)
