"""The device does not answer to small inputs."""

import numpy as np
from numba import njit

from dea.discrepancy.effects._effect import Effect, Family, Port, Scales
from dea.discrepancy.effects._laws import knee
from dea.discrepancy.parameter import Parameter


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Subtract the threshold beyond it (gate 0), or let the whole input through (gate 1)."""
    threshold, width, gate, ratio = q[0], q[1], q[2], q[3]
    result = np.empty(u.size)
    for k in range(u.size):
        limit = threshold if u[k] >= 0 else threshold * ratio
        rest = knee(abs(u[k]) - limit, width)
        opened = 1.0 / (1.0 + np.exp(-2.0 * (abs(u[k]) - limit) / width))
        result[k] = np.sign(u[k]) * ((1.0 - gate) * rest + gate * abs(u[k]) * opened)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return threshold, corner width, gate and the ratio of the negative threshold."""
    unit, peak = scales.u_unit, scales.u_peak
    return (
        Parameter("threshold", unit, 0.5 * peak, 0.3 * peak, 0.0, peak),
        Parameter("corner_width", unit, 0.02 * peak, 1.5, 1e-3 * peak, peak, log=True),
        Parameter("gate", "1", 0.0, 0.5, 0.0, 1.0),
        Parameter("negative_ratio", "1", 1.0, 0.5 if scales.bipolar else 0.0, 0.0, 5.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return thresholds through the range of the input, with both kinds of gate."""
    low = max(scales.u_low, 0.0)
    return tuple(
        (low + part * (scales.u_high - low), width * scales.u_peak, gate, 1.0)
        for part, width, gate in (
            (0.05, 0.02, 0.0),
            (0.15, 0.1, 1.0),
            (0.25, 0.05, 0.0),
            (0.35, 0.02, 1.0),
            (0.35, 0.15, 1.0),
            (0.5, 0.05, 0.0),
        )
    )


EFFECT = Effect(
    name="dead_zone",
    port=Port.INPUT,
    family=Family.THRESHOLD,
    signature="below a threshold of the input the simulation moves and the device does not",
    citation="Tao and Kokotovic (1996), Adaptive Control of Systems with Actuator and Sensor "
    "Nonlinearities, chapter 2",
    parameters=parameters,
    starts=starts,
    shape_input=law,
)
