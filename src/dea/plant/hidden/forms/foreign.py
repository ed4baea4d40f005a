"""Effects on command and reading that a catalogue of common effects does not hold."""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.array import Values
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, foreign, tuning
from dea.plant.hidden.forms.kernels import note, noted
from dea.plant.signal_law import SignalLaw

Kernel = Callable[[Array, Array, Array], None]


def _input(kernel: Kernel, constants: Values, memory: Values = (0.0,)) -> Built:
    return Built(SignalLaw(kernel, constants, memory), {})


def _output(kernel: Kernel, constants: Values, memory: Values = (0.0,)) -> Built:
    return Built(SignalLaw(kernel, constants, memory, output=True), {})


@njit(cache=True)
def _factor(change: float) -> float:
    """Return the factor on a command whose square gains a share, or loses at most 0.95."""
    value: float = np.sqrt(max(1.0 + change, 0.05))
    return value


@njit(cache=True)
def _self_heating(c: Array, m: Array, u: Array) -> None:
    """A temperature that the square of the command drives changes the command's gain."""
    change, time, power, highest = c
    for k in range(u.shape[0]):
        drive = (u[k] / highest) ** 2
        u[k] *= _factor(change * m[0] ** power)
        m[0] += SUBSTEP / time * (drive - m[0])


@tuning("Medalia, Rubber Chem. Technol. 64 (1991) 481: elastomers that heat themselves")
def thermal_feedback(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gain that depends on the temperature which the squared command causes."""
    change = size if rng.random() < 0.5 else -min(size, 0.9)
    time = conditions.time * rng.uniform(8.0, 30.0)
    return _input(_self_heating, [change, time, rng.uniform(1.5, 3.0), conditions.high])


@njit(cache=True)
def _stick(c: Array, m: Array, y: Array) -> None:
    """Hold the reading until it is wrong by more than a threshold, then jump."""
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0]
    for k in range(y.shape[0]):
        if abs(y[k] - m[1]) > c[0]:
            m[1] = y[k]
        y[k] = m[1]


@tuning("Miskowicz, Sensors 6 (2006) 49: send-on-delta sampling")
def send_on_delta(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A reading that is held until it is wrong by ``size`` travels."""
    return _output(_stick, [size * conditions.travel], [0.0, 0.0])


@njit(cache=True)
def _telegraph(c: Array, m: Array, u: Array) -> None:
    """c holds the gain while the contact is bad, then the times at which it changes."""
    for k in range(u.shape[0]):
        if np.searchsorted(c[1:], m[0]) % 2 == 1:
            u[k] *= c[0]
        m[0] += SUBSTEP


@tuning("Machlup, J. Appl. Phys. 25 (1954) 341: a random telegraph signal")
def telegraph_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A contact that fails at random times and takes away ``size`` of the command."""
    mean = conditions.time * rng.uniform(1.0, 6.0)
    lengths = rng.exponential(mean, 2 + 3 * int(conditions.duration / mean))
    return _input(_telegraph, np.concatenate([[1.0 - min(size, 1.0)], np.cumsum(lengths)]))


@njit(cache=True)
def _loaded_delay(c: Array, m: Array, u: Array) -> None:
    """A delay that grows with the command: m holds the count and a ring of past values."""
    longest, low, high = c
    for k in range(u.shape[0]):
        note(m, u[k])
        share = min(max((u[k] - low) / (high - low), 0.0), 1.0)
        u[k] = noted(m, int(longest * share / SUBSTEP))


@tuning("Zenger and Niemi, J. Process Control 19 (2009) 1511: a delay that depends on the flow")
def input_dependent_delay(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A delay from none at the lowest command to ``size`` band periods at the highest."""
    seconds = size * conditions.time * rng.uniform(0.9, 1.1)
    ring = np.zeros(3 + int(np.ceil(seconds / SUBSTEP)))
    return _input(_loaded_delay, [seconds, conditions.low, conditions.high], ring)


@njit(cache=True)
def _dropouts(c: Array, m: Array, y: Array) -> None:
    """c holds the times at which the signal freezes and resumes, in turn."""
    for k in range(y.shape[0]):
        if np.searchsorted(c, m[0]) % 2 == 1:
            y[k] = m[1]
        m[1] = y[k]
        m[0] += SUBSTEP


def _gaps(size: float, conditions: Conditions, rng: Generator) -> Array:
    """Return the times of random gaps of ``size`` band periods, every few periods."""
    every = conditions.time * rng.uniform(2.0, 8.0)
    pairs = rng.exponential(
        [every, size * conditions.time], (2 + int(2 * conditions.duration / every), 2)
    )
    times: Array = np.cumsum(pairs.ravel())
    return times


@tuning("Gilbert, Bell Syst. Tech. J. 39 (1960) 1253: bursts of lost readings, the last one held")
def held_readings(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A reading that freezes every few band periods for about ``size`` band periods."""
    return _output(_dropouts, _gaps(size, conditions, rng), [0.0, 0.0])


@njit(cache=True)
def _modulate(c: Array, m: Array, u: Array) -> None:
    height, frequency, phase, second = c
    for k in range(u.shape[0]):
        angle = 2.0 * np.pi * frequency * m[0] + phase
        u[k] *= _factor(height * (np.sin(angle) + second * np.sin(2.0 * angle)))
        m[0] += SUBSTEP


@tuning("Wereley, Linear time periodic systems (MIT, 1991): a periodically modulated gain")
def modulated_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A supply that modulates the gain by a share ``size``, at 0.3 to 5 times the band."""
    frequency = 10.0 ** rng.uniform(-0.5, 0.7) / conditions.time
    return _input(_modulate, [size, frequency, rng.uniform(0, 6.28), rng.uniform(0, 0.4)])


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
        u[k] = now * _factor(change * share)


@tuning("Brokate and Sprekels, Hysteresis and Phase Transitions (1996): a memory of local maxima")
def peak_memory(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gain that the last peak of the command changes by up to a share ``size``."""
    change = size if rng.random() < 0.5 else -min(size, 0.9)
    return _input(_last_peak, [change, conditions.low, conditions.high], np.zeros(4))


@njit(cache=True)
def _coarse(c: Array, m: Array, u: Array) -> None:
    for k in range(u.shape[0]):
        u[k] = c[0] * np.rint((u[k] - c[1]) / c[0]) + c[1]


@tuning("Widrow and Kollár, Quantization Noise (2008): a converter of few levels")
def coarse_commands(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Commands rounded to levels that are ``size`` times their range apart."""
    step = size * conditions.span
    return _input(_coarse, [step, conditions.low + rng.random() * step])


@njit(cache=True)
def _added_noise(c: Array, m: Array, u: Array) -> None:
    """Add a table c[1:] of values c[0] seconds apart, with straight pieces between; it repeats."""
    values = c.shape[0] - 1
    for k in range(u.shape[0]):
        place = m[0] * SUBSTEP / c[0]
        i = int(place)
        here, ahead = c[1 + i % values], c[1 + (i + 1) % values]
        u[k] += here + (place - i) * (ahead - here)
        m[0] += 1.0


@tuning("Uhlenbeck and Ornstein, Phys. Rev. 36 (1930) 823: coloured noise, here on the command")
def unsteady_supply(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Noise of RMS ``size`` times the range, correlated over 0.2 to 1.5 band periods."""
    apart, correlation = 0.02, rng.uniform(0.2, 1.5)
    kept = np.exp(-apart / correlation)
    values = rng.standard_normal(2 + int(1.2 * conditions.duration / (apart * conditions.time)))
    for k in range(1, values.size):
        values[k] = kept * values[k - 1] + np.sqrt(1.0 - kept**2) * values[k]
    return _input(_added_noise, np.append(apart * conditions.time, size * conditions.span * values))


@njit(cache=True)
def _spikes(c: Array, m: Array, y: Array) -> None:
    """c holds (start, height) of every spike, and how long one lasts; m the time and the next."""
    count = c.shape[0] // 2
    for k in range(y.shape[0]):
        while m[1] < count and c[2 * int(m[1])] + c[-1] < m[0]:
            m[1] += 1.0
        i = int(m[1])
        if i < count and c[2 * i] <= m[0]:
            y[k] += c[2 * i + 1]
        m[0] += SUBSTEP


@tuning("Tukey, Contributions to Probability and Statistics (1960) 448: contaminated readings")
def outliers(size: float, conditions: Conditions, rng: Generator) -> Built:
    """One reading in twenty or so is wrong by some ``size`` travels."""
    length = 0.01 * conditions.time
    every = rng.uniform(15.0, 40.0) * length
    starts = np.cumsum(rng.exponential(every, 2 + int(2 * conditions.duration / every)))
    heights = size * conditions.travel * rng.standard_t(3.0, starts.size)
    constants = np.append(np.column_stack([starts, heights]).ravel(), length)
    return _output(_spikes, constants, [0.0, 0.0])


@tuning("Elliott, Bell Syst. Tech. J. 42 (1963) 1977: bursts of lost commands, the last one held")
def lost_commands(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Commands that are lost every few band periods for about ``size`` band periods."""
    return _input(_dropouts, _gaps(size, conditions, rng), [0.0, 0.0])


@njit(cache=True)
def _lorenz(c: Array, m: Array, u: Array) -> None:
    """A chaotic state of Lorenz's equations multiplies the command; m holds x, y and z."""
    size, pace = c
    dt = SUBSTEP * pace
    for k in range(u.shape[0]):
        x, y, z = m
        u[k] *= _factor(size * x / 8.0)
        m[0] = x + dt * 10.0 * (y - x)
        m[1] = y + dt * (x * (28.0 - z) - y)
        m[2] = z + dt * (x * y - 8.0 / 3.0 * z)


@tuning("Lorenz, J. Atmos. Sci. 20 (1963) 130: an unmeasured chaotic input")
def unmeasured_input(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An unmeasured input that multiplies the first, of RMS about ``size``."""
    start = np.array([1.0, 1.0, 20.0]) + rng.uniform(0.0, 5.0, 3)
    return _input(_lorenz, [size, rng.uniform(0.3, 1.5) / conditions.time], start)


@njit(cache=True)
def _direction(c: Array, m: Array, u: Array) -> None:
    """A larger gain while the command rises; m: started, last value, smooth sign, direction."""
    size, share = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, u[0]
    for k in range(u.shape[0]):
        now = u[k]
        if now != m[1]:
            m[3] = np.sign(now - m[1])
        m[2] += share * (m[3] - m[2])
        m[1] = now
        u[k] = now * _factor(size * m[2])


@tuning(
    "Tan and Godfrey, IEE Proc. Control Theory Appl. 148 (2001) 362: direction-dependent dynamics"
)
def direction_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain is larger while the command rises than while it falls."""
    share = SUBSTEP / (rng.uniform(0.05, 0.3) * conditions.time)
    return _input(_direction, [size * rng.choice([-1.0, 1.0]), share], np.zeros(4))


@njit(cache=True)
def _slow_clock(c: Array, m: Array, u: Array) -> None:
    """A clock that is late by a growing time: m holds the count and a ring of past values."""
    latest, duration, power = c
    for k in range(u.shape[0]):
        share = min(m[0] * SUBSTEP / duration, 1.0) ** power
        note(m, u[k])
        u[k] = noted(m, int(latest * share / SUBSTEP))


@tuning("Allan, Proc. IEEE 54 (1966) 221: a clock that drifts")
def drifting_clock(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The command comes later and later, by ``size`` band periods at the end."""
    seconds = size * conditions.time
    ring = np.zeros(3 + int(np.ceil(seconds / SUBSTEP)))
    return _input(_slow_clock, [seconds, conditions.duration, rng.uniform(0.7, 2.0)], ring)


@njit(cache=True)
def _speckle(c: Array, m: Array, y: Array) -> None:
    """Noise in proportion to the distance from a place, from a table that repeats."""
    size, place, hold = c[0], c[1], int(c[2])
    for k in range(y.shape[0]):
        y[k] += size * (y[k] - place) * c[3 + int(m[0]) // hold % (c.shape[0] - 3)]
        m[0] += 1.0


@tuning("Goodman, Speckle Phenomena in Optics (2007): noise in proportion to the signal")
def speckle(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A reading with noise that grows with the distance from the bottom."""
    hold = max(round(0.02 * conditions.time / SUBSTEP), 1)
    noise = rng.standard_normal(20_000)
    return _output(_speckle, np.concatenate([[size, conditions.bottom, hold], noise]))


EFFECTS = (
    foreign(thermal_feedback, 0.005, 1.5),
    foreign(send_on_delta, 0.005, 0.7),
    foreign(telegraph_contact, 0.002, 0.9),
    foreign(input_dependent_delay, 0.01, 1.5, "band periods"),
    foreign(held_readings, 0.05, 4.0, "band periods"),
    foreign(modulated_gain, 0.002, 0.9),
    foreign(peak_memory, 0.005, 1.5),
    foreign(coarse_commands, 0.01, 0.7),
    foreign(unsteady_supply, 0.001, 0.4),
    foreign(outliers, 0.002, 0.5),
    foreign(lost_commands, 0.05, 4.0, "band periods"),
    foreign(unmeasured_input, 0.002, 0.6),
    foreign(direction_gain, 0.002, 0.8),
    foreign(drifting_clock, 0.01, 1.5, "band periods"),
    foreign(speckle, 0.002, 0.8),
)
