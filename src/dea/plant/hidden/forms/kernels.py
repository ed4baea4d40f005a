"""Kernels that several forms of laws on a signal share: curves, courses in time, linear filters."""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Conditions
from dea.plant.signal_law import SignalLaw

_CURVE_POINTS, _COURSE_POINTS = 8001, 4001


@njit(cache=True)
def between(table: Array, low: float, step: float, x: float) -> float:
    """Interpolate in an evenly spaced table, and beyond its ends along its last pieces."""
    last = table.shape[0] - 2
    place = (x - low) / step
    i = min(max(int(place), 0), last)
    value: float = table[i] + (place - i) * (table[i + 1] - table[i])
    return value


@njit(cache=True)
def _mapped(c: Array, m: Array, signal: Array) -> None:
    for k in range(signal.shape[0]):
        signal[k] = between(c[2:], c[0], c[1], signal[k])


def _curve(
    function: Callable[[Array], Array], low: float, high: float, *, output: bool = False
) -> SignalLaw:
    """Return the law that maps a signal by ``function``, tabulated from ``low`` to ``high``."""
    places = np.linspace(low, high, _CURVE_POINTS)
    constants = np.concatenate([[low, places[1] - places[0]], function(places)])
    return SignalLaw(_mapped, constants, output=output)


def command_curve(function: Callable[[Array], Array], conditions: Conditions) -> SignalLaw:
    """Return the law on the command, tabulated from 0 V to twice the highest command."""
    return _curve(function, 0.0, 2.0 * conditions.high)


def reading_curve(function: Callable[[Array], Array], conditions: Conditions) -> SignalLaw:
    """Return the law on the reading, from four travels below its plain range to four above."""
    reach = 4.0 * conditions.travel
    return _curve(function, conditions.bottom - reach, conditions.top + reach, output=True)


def true_at_ends(signal: Callable[[Array], Array], conditions: Conditions) -> SignalLaw:
    """Return the reading of a sensor's signal, scaled to be true at both ends of the travel."""
    low, high = signal(np.array([conditions.bottom, conditions.top]))
    scale = conditions.travel / (high - low)
    return reading_curve(lambda y: conditions.bottom + scale * (signal(y) - low), conditions)


def bent_above(knee: float, bend: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Return the curve that changes nothing up to a knee, and is ``bend(d)`` above it at d over."""
    return lambda x: np.minimum(x, knee) + bend(np.maximum(x - knee, 0.0))


def sign(size: float, rng: Generator) -> float:
    """Return -1 or 1, down or up; 1 for a large change, since no gain would leave no response."""
    return float(rng.choice([-1.0, 1.0])) if size < 0.5 else 1.0


@njit(cache=True)
def _scaled(c: Array, m: Array, signal: Array) -> None:
    for k in range(signal.shape[0]):
        signal[k] *= max(1.0 + _until_end(c, m[0]), 0.0) ** c[1]
        m[0] += SUBSTEP


@njit(cache=True)
def _shifted(c: Array, m: Array, signal: Array) -> None:
    for k in range(signal.shape[0]):
        signal[k] += _until_end(c, m[0])
        m[0] += SUBSTEP


@njit(cache=True)
def _until_end(c: Array, t: float) -> float:
    """Return the course's value at time ``t``; it keeps its last value after its end."""
    return between(c[2:], 0.0, c[0], min(t, c[0] * (c.shape[0] - 3)))


def gain_course(course: Callable[[Array], Array], duration: float, power: float) -> SignalLaw:
    """Return the law that multiplies what drives the device by 1 + ``course(time)``.

    The drive is the command to the ``power``.
    """
    times = np.linspace(0.0, duration, _COURSE_POINTS)
    return SignalLaw(_scaled, np.concatenate([[times[1], 1.0 / power], course(times)]))


def added_course(course: Callable[[Array], Array], duration: float) -> SignalLaw:
    """Return the law that adds ``course(time)`` to the reading."""
    times = np.linspace(0.0, duration, _COURSE_POINTS)
    constants = np.concatenate([[times[1], 1.0], course(times)])
    return SignalLaw(_shifted, constants, output=True)


@njit(cache=True)
def note(m: Array, value: float) -> None:
    """Note a value in a memory that holds how many there have been and a ring of the latest."""
    if m[0] == 0.0:
        m[1:] = value
    m[1 + int(m[0]) % (m.shape[0] - 1)] = value
    m[0] += 1.0


@njit(cache=True)
def noted(m: Array, late: int) -> float:
    """Return the value noted ``late`` values before the latest."""
    value: float = m[1 + (int(m[0]) - 1 - late) % (m.shape[0] - 1)]
    return value


@njit(cache=True)
def _cascaded(c: Array, m: Array, signal: Array) -> None:
    """c holds the shares that the poles pass in a sub-step, m whether started and their values."""
    if m[0] == 0.0:
        m[0] = 1.0
        m[1:] = signal[0]
    for k in range(signal.shape[0]):
        value = signal[k]
        for i in range(c.shape[0]):
            m[1 + i] += c[i] * (value - m[1 + i])
            value = m[1 + i]
        signal[k] = value


def cascade(times: Array, *, output: bool = False) -> SignalLaw:
    """Return first-order lags with time constants ``times`` (s), one after the other.

    Each is stepped so that its mean delay is its time constant exactly, however many there are.
    """
    shares = SUBSTEP / (np.asarray(times) + SUBSTEP)
    return SignalLaw(_cascaded, shares, np.zeros(1 + shares.size), output=output)


@njit(cache=True)
def _parallel(c: Array, m: Array, signal: Array) -> None:
    """c holds the direct share, then (weight, share per sub-step) of every pole."""
    poles = m.shape[0] - 1
    if m[0] == 0.0:
        m[0] = 1.0
        m[1:] = signal[0] if c[1] > 0.0 else 0.0
    for k in range(signal.shape[0]):
        value = c[0] * signal[k]
        for i in range(poles):
            m[1 + i] += c[3 + 2 * i] * (signal[k] - m[1 + i])
            value += c[2 + 2 * i] * m[1 + i]
        signal[k] = value


def parallel(
    direct: float, weights: Array, times: Array, *, settled: bool = True, output: bool = False
) -> SignalLaw:
    """Return ``direct`` times the signal plus weighted first-order lags of it, side by side.

    ``settled`` lags start at the first value of the signal, others at 0.
    """
    poles = np.column_stack([weights, 1.0 - np.exp(-SUBSTEP / np.asarray(times))]).ravel()
    constants = np.concatenate([[direct, float(settled)], poles])
    return SignalLaw(_parallel, constants, np.zeros(1 + len(times)), output=output)
