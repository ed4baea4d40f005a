"""The sensor responds with a lag."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import delayed, low_pass
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
    may be quicker where the output is high: their poles are then multiplied by a rate.
    """
    time_constant, damping, delay_ratio, fast, quickening, middle, half_range = q
    samples = time_constant / interval
    if quickening == 0.0:
        smooth = low_pass(y, [(0.5 * samples / damping) ** 2, samples, 1.0])
        if fast > 0.0:
            smooth = (1.0 - fast) * smooth + fast * low_pass(y, [_FAST * samples, 1.0])
    else:
        rate = np.exp(quickening * np.clip((y - middle) / half_range, -2.0, 2.0))
        smooth = _quickened(y, rate, *_modes(samples, damping, fast))
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
    y: np.ndarray, rate: np.ndarray, poles: np.ndarray, residues: np.ndarray
) -> np.ndarray:
    """Return a signal that is straight between samples behind modes that a rate makes quicker.

    The modes stand at rest at the first sample; the rate is the mean of an interval's two ends.
    """
    result = np.zeros(y.size)
    for i in range(poles.size):
        pole, residue = poles[i], residues[i]
        held = -y[0] / pole
        for k in range(y.size):
            result[k] += (residue * held).real
            if k + 1 < y.size:
                span = 0.5 * (rate[k] + rate[k + 1])
                decay = np.exp(pole * span)
                level = (decay - 1.0) / pole
                held = decay * held + y[k] * level
                held += (y[k + 1] - y[k]) / span * (level - span) / pole
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the time constant 2ζ/ω₀, the damping ratio ζ, dead time over it, and the fast part.

    And the logarithm of the rate at the upper end of the range, over that in its middle.
    """
    dt, middle = scales.interval, 0.5 * (scales.y_low + scales.y_high)
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.3 * scales.duration, log=True),
        Parameter("damping", "1", 1.5, 0.7, 0.15, 5.0, log=True, shape=True),
        Parameter("delay_ratio", "1", 0.0, 0.5, 0.0, 3.0, shape=True),
        Parameter("fast_part", "1", 0.0, 0.15, 0.0, 0.9, shape=True),
        Parameter("quickening", "1", 0.0, 0.3, -2.0, 2.0, shape=True),
        Parameter("middle", scales.y_unit, middle, 0.0),
        Parameter("half_range", scales.y_unit, 0.5 * scales.y_span, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return time constants of a few intervals."""
    rest = (0.0, 0.0, 0.0, 0.5 * (scales.y_low + scales.y_high), 0.5 * scales.y_span)
    return tuple((samples * scales.interval, 1.5, *rest) for samples in (2.0, 8.0, 30.0))


EFFECT = Effect(
    name="sensor_lag",
    port=Port.OUTPUT,
    family=Family.LAG,
    symptom="the measured output is a smoothed copy of the simulated one",
    citation="Doebelin (2003), Measurement Systems, section 3.3, on second-order instruments; "
    "Carslaw and Jaeger (1959), Conduction of Heat in Solids, on their modes; Busch and "
    "Kristensen (1976), Journal of Applied Meteorology 15:1328, on a level that quickens them",
    parameters=parameters,
    starts=starts,
    shape_output=law,
)
