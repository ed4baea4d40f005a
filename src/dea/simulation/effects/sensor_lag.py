"""The sensor responds with a lag."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, held_charge, low_pass, powered, time_at
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# Time constant of the fast part over that of the slow one: about the mean of the further modes of
# heat that diffuses into a sphere, whose times fall as 1/n² (0.13 by their parts).
_FAST = 0.15
# A double pole is taken apart by this part of the damping, since modes need two.
_APART = 1e-4


def law(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass the output through a second-order lag, which may ring, and read it late.

    A part of it passes through a faster lag instead, as in a body that warms from outside. The lags
    may be quicker where the output is high, or where the reading is: their poles are then
    multiplied by a rate. They may be quicker the larger the error is, as in a body that air cools
    by its own convection: the rate is then a power ``order`` of the error, in units of half the
    range.
    """
    time_constant, damping, delay_ratio, fast, quickening, own_share, order, middle, half_range = q
    samples = time_constant / interval
    if quickening == 0.0:
        smooth = low_pass(y, [(0.5 * samples / damping) ** 2, samples, 1.0])
        if fast > 0.0:
            smooth = (1.0 - fast) * smooth + fast * low_pass(y, [_FAST * samples, 1.0])
    else:
        high = (y - middle) / half_range
        quick = _quickened(high, quickening, own_share, *_modes(samples, damping, fast))
        smooth = middle + half_range * quick
    if order > 1.0:
        smooth = smooth + (1.0 - fast) * _powered(y, time_constant, order, half_range, interval)
    return delayed(smooth, time_constant * delay_ratio, interval)


def _modes(samples: float, damping: float, fast: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the poles of the lags per sample, and their residues, both (3,)."""
    apart = damping * (1.0 + _APART) if abs(damping - 1.0) < 0.5 * _APART else damping
    square = (0.5 * samples / apart) ** 2
    slow = np.roots([square, samples, 1.0]).astype(complex)
    quick = 1.0 / (_FAST * samples)
    residues = (1.0 - fast) / (square * (slow - slow[::-1]))
    return np.append(slow, -quick), np.append(residues, fast * quick)


@njit(cache=True, error_model="numpy")
def _quickened(
    y: np.ndarray, quickening: float, own_share: float, poles: np.ndarray, residues: np.ndarray
) -> np.ndarray:
    """Return a signal that is straight between samples behind modes that a rate makes quicker.

    The modes stand at rest at the first sample. The logarithm of an interval's rate is
    ``quickening`` times its level: of the mean signal, and by ``own_share`` of the mean reading,
    which is extrapolated from the interval before and rough where that is as long as the lag.
    """
    result = np.empty(y.size)
    held = -y[0] / poles
    for k in range(y.size):
        result[k] = np.sum((residues * held).real)
        if k + 1 < y.size:
            read = result[k] + 0.5 * (result[k] - result[max(k - 1, 0)])
            level = own_share * read + (1.0 - own_share) * 0.5 * (y[k] + y[k + 1])
            span = np.exp(quickening * min(max(level, -2.0), 2.0))
            for i in range(poles.size):
                decay = np.exp(poles[i] * span)
                rise = (decay - 1.0) / poles[i]
                straight = (y[k + 1] - y[k]) / span * (rise - span) / poles[i]
                held[i] = decay * held[i] + y[k] * rise + straight
    return result


@njit(cache=True, error_model="numpy")
def _powered(
    y: np.ndarray, time_constant: float, order: float, full: float, interval: float
) -> np.ndarray:
    """Return what a lag reads more whose rate is a power of its error than one of first order."""
    result = np.zeros(y.size)
    read = linear = y[0]
    for k in range(y.size - 1):
        target = 0.5 * (y[k] + y[k + 1])
        time = time_at(time_constant, target - read, full, order)
        _, read = powered(read, target, time, 1.0, 0.0, interval, order)
        _, linear = held_charge(linear, target, time_constant, 1.0, 0.0, interval)
        result[k + 1] = read - linear
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant 2ζ/ω₀, the damping ratio ζ, dead time over it, and the fast part.

    And the logarithm of the rate at the upper end of the range, over that in its middle, by which
    share the reading sets it, and the power of the error that the rate is.
    """
    dt, middle = scales.interval, scales.y_middle
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.3 * scales.duration, log=True),
        Parameter("damping", "1", 1.5, 0.7, 0.15, 5.0, log=True, shape=True),
        Parameter("delay_ratio", "1", 0.0, 0.5, 0.0, 1.0, shape=True),
        Parameter("fast_part", "1", 0.0, 0.15, 0.0, 0.9, shape=True),
        Parameter("quickening", "1", 0.0, 0.3, -2.0, 2.0, shape=True),
        Parameter("own_share", "1", 0.5, 0.5, 0.0, 1.0, shape=True),
        Parameter("order", "1", 1.0, 0.4, 1.0, 3.0, log=True, shape=True),
        Parameter("middle", scales.y_unit, middle, 0.0),
        Parameter("half_range", scales.y_unit, 0.5 * scales.y_span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return short lags, in a long record a longer one, and a reading that quickens its lag.

    And a slow part, beside which the rest follows at once.
    """
    middle, half = scales.y_middle, 0.5 * scales.y_span
    return (
        *((time, 1.5, 0.0, 0.0, 0.0, 0.5, 1.0, middle, half) for time in scales.lags),
        (8.0 * scales.interval, 4.0, 0.0, 0.0, 0.8, 1.0, 1.0, middle, half),
        (scales.slow, 1.5, 0.0, 0.7, 0.0, 0.5, 1.0, middle, half),
    )


EFFECT = Effect(
    name="sensor_lag",
    port=Port.OUTPUT,
    family=Family.LAG,
    symptom="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, on second-order instruments; "
    "Carslaw and Jaeger (1959), Conduction of Heat in Solids, on their modes; Busch and "
    "Kristensen (1976), Journal of Applied Meteorology 15:1328, on a level that quickens them; "
    "Rose (1963), Concepts in Photoconductivity and Allied Problems, on a reading that does; "
    "McAdams (1954), Heat Transmission, on natural convection",
    parameters=parameters,
    starts=starts,
    shape_output=law,
    defining="time_constant",
)
