"""The device does not respond to small inputs."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import knee
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Pass a power of the excess over the threshold (gate 0), or the whole input there (gate 1).

    Once it is overcome, the threshold falls by the part ``drop``, until the input is below what is
    left of it.
    """
    threshold, width, gate, ratio, slope = q[0], q[1], q[2], q[3], q[4]
    exponent, bend, jump, peak, drop = q[5], q[6], q[7], q[8], q[9]
    if threshold == 0.0:
        width = 0.0  # without a threshold a corner would be a jump at zero
    result = np.empty(u.size)
    overcome = 0.0
    for k in range(u.size):
        limit = threshold if u[k] >= 0 else threshold * ratio
        if abs(u[k]) > limit:
            overcome = np.sign(u[k])
        elif abs(u[k]) <= (1.0 - drop) * limit - width or u[k] * overcome <= 0.0:
            overcome = 0.0
        if overcome != 0.0:
            limit *= 1.0 - drop
        beyond = abs(u[k]) - limit
        excess = knee(beyond, width) / peak
        rest = slope * peak * excess**exponent * (1.0 + bend * excess)
        opened = 1.0 / (1.0 + np.exp(-2.0 * beyond / jump))
        result[k] = np.sign(u[k]) * ((1.0 - gate) * rest + gate * abs(u[k]) * opened)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the threshold, its corner and gate, and the course of what passes beyond it.

    And the part of the threshold that is gone once it is overcome.
    """
    unit, peak = scales.u_unit, scales.u_peak
    return (
        Parameter("threshold", unit, 0.5 * peak, 0.3 * peak, 0.0, peak),
        Parameter("corner_width", unit, 0.02 * peak, 1.5, 1e-3 * peak, peak, log=True, shape=True),
        Parameter("gate", "1", 0.0, 0.5, 0.0, 1.0, shape=True),
        Parameter("negative_ratio", "1", 1.0, 0.5 if scales.bipolar else 0.0, 0.0, 5.0),
        Parameter("slope", "1", 1.0, 0.3, 0.3, 5.0, log=True),
        Parameter("exponent", "1", 1.0, 0.3, 0.4, 3.0, log=True, shape=True),
        # At the least exponent and bend the law is flat at the end of the range, and never falls.
        Parameter("bend", "1", 0.0, 0.3, -0.28, 5.0, shape=True),
        Parameter("jump_width", unit, 0.01 * peak, 0.0),
        Parameter("range", unit, peak, 0.0),
        Parameter("drop", "1", 0.0, 0.2, 0.0, 0.7, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return thresholds through the range of the input, with both kinds of gate, or a drop."""
    low, peak = max(scales.u_low, -scales.u_high, 0.0), scales.u_peak

    def zone(part: float, gate: float = 0.0, drop: float = 0.0) -> tuple[float, ...]:
        threshold = low + part * (peak - low)
        # The largest input passes unchanged, as in the fitted simulation.
        slope = peak / (peak - (1.0 - drop) * threshold)
        return (threshold, 0.04 * peak, gate, 1.0, slope, 1.0, 0.0, 0.01 * peak, peak, drop)

    zones = (zone(part) for part in (0.05, 0.15, 0.25, 0.37, 0.5))
    return (*zones, zone(0.3, gate=1.0), *(zone(part, drop=0.3) for part in (0.25, 0.5)))


EFFECT = Effect(
    name="dead_zone",
    port=Port.INPUT,
    family=Family.THRESHOLD,
    symptom="below a threshold of the input the simulation moves and the device does not",
    citation="Tao and Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor "
    "Nonlinearities, chapter 2; beyond a yield as a power: Herschel and Bulkley (1926); "
    "with a drop: Pearson and Anson (1922), Proceedings of the Physical Society 34:204",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    essential="threshold",
    defining="threshold",
)
