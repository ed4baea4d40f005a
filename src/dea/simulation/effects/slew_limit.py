"""The rate of change of the input is limited."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import limited
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

_PARTS = 4


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Follow the input at a speed that is limited and lags; return means over the intervals.

    Without a lag of the speed this is a first-order lag whose rate saturates: abruptly, or
    gradually like that of a differential pair. With such a lag, like that of the speed loop of a
    servo, a rise begins gradually; where that is longer than a quarter of the lag of the place, the
    rise passes the target and rings about it. Each rate may grow from the middle of the input's
    range to its upper end, as that of a supply whose current folds back.
    """
    rising, falling, tau, inertia = q[0], q[0] * q[1], q[2], q[3]
    h = interval / _PARTS
    near = (1.0 - np.exp(-h / tau)) / h
    taken_up = 1.0 - np.exp(-h / inertia) if inertia > 1e-3 * h else 1.0
    result = np.empty(u.size)
    v, speed = u[0], 0.0
    for k in range(u.size):
        total = 0.0
        for _ in range(_PARTS):
            level = min(max((v - q[6]) / q[7], -1.0), 1.0)
            most, least = rising * (1.0 + q[4] * level), -falling * (1.0 + q[5] * level)
            asked = (u[k] - v) * near
            reached = np.sign(asked) * limited(abs(asked), most if asked > 0.0 else -least, q[8])
            speed += (reached - speed) * taken_up
            total += v + 0.5 * speed * h
            v += speed * h
        result[k] = total / _PARTS
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the rates, lags, how each rate grows, and how sharp the limit is."""
    rate, dt = max(scales.u_rate, 1e-9), scales.interval
    middle, half = scales.u_middle, 0.5 * max(scales.u_span, 1e-9)
    return (
        Parameter("rate", f"{scales.u_unit}/s", 0.5 * rate, 1.0, 1e-4 * rate, 1e3 * rate, log=True),
        Parameter("falling_ratio", "1", 1.0, 0.3, 0.1, 10.0, log=True),
        Parameter("lag", "s", 0.2 * dt, 1.0, 0.02 * dt, 30 * dt, log=True, shape=True),
        Parameter("speed_lag", "s", 0.0, 10 * dt, 0.0, 0.1 * scales.duration, shape=True),
        Parameter("rise_growth", "1", 0.0, 0.3, -0.9, 0.9, shape=True),
        Parameter("fall_growth", "1", 0.0, 0.3, -0.9, 0.9, shape=True),
        Parameter("middle", scales.u_unit, middle, 0.0),
        Parameter("half_range", scales.u_unit, half, 0.0),
        Parameter("sharpness", "1", 30.0, 1.0, 1.0, 200.0, log=True, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return rates below the fastest change of the input, and one equal to it with a lag."""
    dt = scales.interval
    middle, half = scales.u_middle, 0.5 * max(scales.u_span, 1e-9)
    return tuple(
        (part * scales.u_rate, 1.0, lag * dt, 0.5 * dt, 0.0, 0.0, middle, half, 30.0)
        for part, lag in ((1.0, 3.0), (0.7, 0.2), (0.4, 0.2), (0.2, 0.2), (0.05, 0.2))
    )


EFFECT = Effect(
    name="slew_limit",
    port=Port.INPUT,
    family=Family.LAG,
    symptom="the device lags behind fast changes of the input, the more the larger they are",
    citation="Duda (1998), Journal of Guidance, Control, and Dynamics 21:1, on rate limiters; "
    "Solomon (1974), IEEE Journal of Solid-State Circuits 9:314, on a differential pair",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    essential="rate",
    vanishes_at="high",
    defining="rate",
)
