"""Charge leaks through the film, faster at a higher field."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port, Quantity
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Lose a part of the field that grows with its size and builds up with a time constant.

    That is the time constant of the field where the loss does not grow: a large loss is that of a
    high-pass filter. At a higher field, which lowers the resistance, it may be shorter. The field
    is the input less the loss. The loss at the start of the record is unknown.

    A step is the exponential one of Rosenbrock and Euler in a time that runs with the rate. It
    goes no further than a step of Newton's method towards the field at which the loss stays, so
    that no field swings about that one, however fast the loss grows.
    """
    loss, growth, tau, peak, started, quickening = q[0], q[1], q[2], q[3], q[4], q[5]
    result = np.empty(u.size)
    at_start = loss * np.exp(growth * (abs(u[0]) / peak - 1.0))
    lost = started * at_start / (1.0 + at_start) * u[0]
    for k in range(u.size):
        field = u[k] - lost
        grown = growth * abs(field) / peak
        lossy = loss * np.exp(grown - growth)
        slope = 1.0 + lossy * (1.0 + grown)
        distance = (lossy * field - lost) / slope
        steps = slope * interval / (tau * (1.0 + loss))
        if quickening > 0.0:
            # The rate in the middle of the step, which one at the rate of its start predicts.
            early = steps * np.exp(quickening * abs(field) / peak)
            middle = field + 0.5 * distance * np.expm1(-early)
            steps *= np.exp(quickening * abs(middle) / peak)
        followed = -np.expm1(-steps)
        result[k] = field - distance * (1.0 - followed / steps)
        lost += distance * followed
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the loss over the field at full field, its growth, and its time constant.

    Then its part at the start, and the logarithm of how much faster it builds up at full field.
    """
    dt, peak = scales.interval, scales.u_peak
    return (
        Parameter("loss", "1", 0.1, 1.0, 1e-4, 1e3, log=True),
        Parameter("field_growth", "1", 0.0, 3.0, 0.0, 20.0, shape=True),
        Parameter("settling_time", "s", 30 * dt, 2.0, 10 * dt, scales.duration, log=True),
        Parameter("full_field", scales.u_unit, peak, 0.0),
        Parameter("start_part", "1", 0.7, 0.4, 0.0, 2.0, at_start=True),
        Parameter("quickening", "1", 0.0, 1.0, 0.0, 8.0, shape=True),
    )


def _lost_part(q: np.ndarray, _: Scales) -> float:
    """Return the part of an input that is lost in the end where it leaves the full field."""
    return float(q[0] / (1.0 + q[0]))


def _settling_time(q: np.ndarray, _: Scales) -> float:
    return float(q[2])


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return slow and fast losses, the faster the more they grow with the field."""
    peak = scales.u_peak
    return tuple(
        (0.1, growth, max(part * scales.duration, 15 * scales.interval), peak, 0.7, 0.0)
        for part, growth in ((0.1, 0.5), (0.02, 0.5), (0.005, 3.0), (1e-3, 6.0))
    )


EFFECT = Effect(
    name="charge_leakage",
    port=Port.INPUT,
    family=Family.RELAXATION,
    symptom="under a held input the device falls back, more at high input",
    citation="Di Lillo et al. (2012), Journal of Applied Physics 111:024904, on leakage currents",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    # At its shortest time the input's curve is bent, and no charge leaks.
    essential="settling_time",
    defining="loss",
    quantities=(
        Quantity("lost_part", "loss", _lost_part),
        Quantity("settling_time", "settling_time", _settling_time),
    ),
)
