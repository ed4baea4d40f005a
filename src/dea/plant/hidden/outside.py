"""Effects that a catalogue of common effects does not hold."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant import forces
from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Conditions, EffectKind, Port
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _self_heating(c: Array, m: Array, u: Array) -> None:
    """A temperature driven by the square of the command raises or lowers the gain."""
    change, time, power, highest = c
    for k in range(u.shape[0]):
        drive = (u[k] / highest) ** 2
        u[k] *= np.sqrt(max(1.0 + change * m[0] ** power, 0.05))
        m[0] += SUBSTEP / time * (drive - m[0])


def thermal_feedback(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a gain that depends non-linearly on the temperature from the squared command."""
    change = size if rng.random() < 0.5 else -min(size, 0.9)
    return SignalLaw(
        _self_heating, [change, rng.uniform(8.0, 30.0), rng.uniform(1.5, 3.0), conditions.high]
    )


@njit(cache=True)
def _stick(c: Array, m: Array, y: Array) -> None:
    """Hold the reading until it is wrong by more than a threshold, then jump."""
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        if abs(y[k] - m[1]) > c[0]:
            m[1] = y[k]
        y[k] = m[1]


def sticking_sensor(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a reading that sticks until it is wrong by ``size`` travels, then jumps."""
    return SignalLaw(_stick, [size * conditions.travel], [0.0, 0.0], output=True)


@njit(cache=True)
def _telegraph(c: Array, m: Array, u: Array) -> None:
    """c holds the gain while the contact is bad, then the times at which it changes."""
    for k in range(u.shape[0]):
        changes = np.searchsorted(c[1:], m[0] * SUBSTEP)
        if changes % 2 == 1:
            u[k] *= c[0]
        m[0] += 1.0


def telegraph_contact(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a contact that fails at random times and takes away ``size`` of the gain."""
    lengths = rng.exponential(rng.uniform(1.0, 6.0), 2 * int(conditions.duration))
    return SignalLaw(_telegraph, np.concatenate([[1.0 - min(size, 1.0)], np.cumsum(lengths)]))


@njit(cache=True)
def _loaded_delay(c: Array, m: Array, u: Array) -> None:
    """A delay that grows with the command: m holds the count and a ring of past values."""
    longest, low, high = c
    length = m.shape[0] - 1
    if m[0] == 0.0:
        m[1:] = u[0]
    for k in range(u.shape[0]):
        place = int(m[0])
        m[1 + place % length] = u[k]
        share = min(max((u[k] - low) / (high - low), 0.0), 1.0)
        u[k] = m[1 + (place - int(longest * share / SUBSTEP)) % length]
        m[0] += 1.0


def input_dependent_delay(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a delay from none at the lowest command to ``size`` seconds at the highest."""
    ring = np.zeros(2 + int(np.ceil(size / SUBSTEP)))
    return SignalLaw(_loaded_delay, [size, conditions.low, conditions.high], np.append(0.0, ring))


@njit(cache=True)
def _dropouts(c: Array, m: Array, y: Array) -> None:
    """c holds the times at which readings freeze and resume, in turn."""
    for k in range(y.shape[0]):
        changes = np.searchsorted(c, m[0] * SUBSTEP)
        if changes % 2 == 1:
            y[k] = m[1]
        m[1] = y[k]
        m[0] += 1.0


def held_samples(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a reading that freezes every few seconds for about ``size`` seconds."""
    lengths = rng.exponential([rng.uniform(2.0, 8.0), size], (int(conditions.duration), 2))
    return SignalLaw(_dropouts, np.cumsum(lengths.ravel()), [0.0, 0.0], output=True)


@njit(cache=True)
def _bursts(c: Array, m: Array, y: Array) -> None:
    """c holds the height, the period and active share of the bursts, and the noise they repeat."""
    height, every, share = c[0], c[1], c[2]
    for k in range(y.shape[0]):
        phase = (m[0] * SUBSTEP / every) % 1.0
        if phase < share:
            y[k] += height * c[3 + int(m[0]) // 20 % (c.shape[0] - 3)]
        m[0] += 1.0


def noise_bursts(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide periodic bursts of noise with a standard deviation of ``size`` travels."""
    noise = rng.standard_normal(20_000)
    clock = [size * conditions.travel, rng.uniform(5.0, 20.0), rng.uniform(0.1, 0.4)]
    return SignalLaw(_bursts, np.concatenate([clock, noise]), output=True)


@njit(cache=True)
def _modulate(c: Array, m: Array, u: Array) -> None:
    height, frequency, phase, second = c
    for k in range(u.shape[0]):
        angle = 2.0 * np.pi * frequency * m[0] * SUBSTEP + phase
        u[k] *= np.sqrt(max(1.0 + height * (np.sin(angle) + second * np.sin(2.0 * angle)), 0.05))
        m[0] += 1.0


def modulated_gain(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a supply that modulates the gain by a share ``size``, at 0.3 to 5 Hz."""
    constants = [size, 10.0 ** rng.uniform(-0.5, 0.7), rng.uniform(0, 6.28), rng.uniform(0, 0.4)]
    return SignalLaw(_modulate, constants)


@njit(cache=True)
def _last_peak(c: Array, m: Array, u: Array) -> None:
    """A gain that depends on the last peak; m holds started, last value, rising and peak."""
    change, low, high = c
    if m[0] == 0.0:
        m[0], m[1], m[3] = 1.0, u[0], u[0]
    for k in range(u.shape[0]):
        now = u[k]
        if now > m[1]:
            m[2] = 1.0
        elif now < m[1]:
            if m[2] == 1.0:
                m[3] = m[1]
            m[2] = 0.0
        m[1] = now
        share = (m[3] - low) / (high - low)
        u[k] = now * np.sqrt(max(1.0 + change * share, 0.05))


def peak_memory(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a gain that the last peak of the command changes by up to a share ``size``."""
    change = size if rng.random() < 0.5 else -min(size, 0.9)
    return SignalLaw(_last_peak, [change, conditions.low, conditions.high], np.zeros(4))


def bistable_snap(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide a buckled strip whose bistable force reaches about ``size`` film forces."""
    force = size * conditions.stiffness * conditions.travel
    place = conditions.bottom + rng.uniform(0.3, 0.6) * conditions.travel
    constants = np.array([force, place, rng.uniform(0.15, 0.35) * conditions.travel])
    return ForceLaw(forces.SNAP_THROUGH, constants, np.zeros(1))


@njit(cache=True)
def _cross_talk(c: Array, m: Array, u: Array) -> None:
    """c holds the height, then (frequency, phase) of every sine of the unmeasured input."""
    sines = (c.shape[0] - 1) // 2
    for k in range(u.shape[0]):
        t = m[0] * SUBSTEP
        unmeasured = 0.0
        for i in range(sines):
            unmeasured += np.sin(2.0 * np.pi * c[1 + 2 * i] * t + c[2 + 2 * i])
        u[k] *= np.sqrt(max(1.0 + c[0] * unmeasured / np.sqrt(0.5 * sines), 0.05))
        m[0] += 1.0


def hidden_input(size: float, conditions: Conditions, rng: Generator) -> SignalLaw:
    """Hide a second, unmeasured input that multiplies the first, of RMS ``size``."""
    sines = np.column_stack([rng.uniform(0.02, 0.6, 8), rng.uniform(0.0, 2.0 * np.pi, 8)])
    return SignalLaw(_cross_talk, np.append(size, sines.ravel()))


EFFECTS = (
    EffectKind("thermal_feedback", Port.OUTSIDE, 0.005, 1.5, "1", thermal_feedback),
    EffectKind("sticking_sensor", Port.OUTSIDE, 0.005, 0.7, "1", sticking_sensor),
    EffectKind("telegraph_contact", Port.OUTSIDE, 0.002, 0.9, "1", telegraph_contact),
    EffectKind("input_dependent_delay", Port.OUTSIDE, 0.01, 1.5, "s", input_dependent_delay),
    EffectKind("held_samples", Port.OUTSIDE, 0.05, 4.0, "s", held_samples),
    EffectKind("noise_bursts", Port.OUTSIDE, 0.003, 0.6, "1", noise_bursts),
    EffectKind("modulated_gain", Port.OUTSIDE, 0.002, 0.9, "1", modulated_gain),
    EffectKind("peak_memory", Port.OUTSIDE, 0.005, 1.5, "1", peak_memory),
    EffectKind("bistable_snap", Port.OUTSIDE, 0.005, 0.4, "1", bistable_snap),
    EffectKind("hidden_input", Port.OUTSIDE, 0.002, 0.4, "1", hidden_input),
)
