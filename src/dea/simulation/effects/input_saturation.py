"""The input saturates at a limit."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import limited
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@njit(inline="always")
def _charged(charge: float, excess: float, recovery: float, duration: float) -> float:
    """Return what is stored after an excess over the limit, which may be negative, has lasted."""
    decay = np.exp(-duration / recovery)
    left: float = max(charge * decay + recovery * (1.0 - decay) * excess, 0.0)
    return left


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Limit either sign softly, and keep a part ``slope`` of what is lost by that.

    With ``recovery`` the excess over the limit stores a charge, which decays with that time, and
    the limit is left when the input below it has removed the charge (Moll 1954).
    """
    limit, sharpness, slope, ratio, recovery = q[0], q[1], q[2], q[3], q[4]
    result = np.empty(u.size)
    charge, side = 0.0, 1.0
    for k in range(u.size):
        inside, rest = 0.0, 1.0
        own = limit if side > 0.0 else limit * ratio
        excess = side * u[k] - own
        if charge > 0.0 and excess < 0.0:
            lasting = recovery * np.log1p(-charge / (recovery * excess))
            held = min(lasting / interval, 1.0)
            inside, rest = held * side * limited(own, own, sharpness), 1.0 - held
            charge = _charged(charge, excess, recovery, interval) if rest == 0.0 else 0.0
        if rest > 0.0:
            side = 1.0 if u[k] >= 0.0 else -1.0
            own = limit if side > 0.0 else limit * ratio
            inside += rest * side * limited(side * u[k], own, sharpness)
            if recovery > 0.0:
                charge = _charged(charge, side * u[k] - own, recovery, rest * interval)
        result[k] = inside + slope * (u[k] - inside)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return limit, sharpness of its corner, remaining slope, negative ratio, and recovery."""
    peak = scales.u_peak
    return (
        Parameter("limit", scales.u_unit, 0.8 * peak, 0.3 * peak, 0.05 * peak, 3.0 * peak),
        Parameter("sharpness", "1", 8.0, 1.0, 1.0, 200.0, log=True, shape=True),
        Parameter("remaining_slope", "1", 0.0, 0.1, 0.0, 0.25, shape=True),
        Parameter("negative_ratio", "1", 1.0, 0.5 if scales.bipolar else 0.0, 0.0, 5.0),
        Parameter(
            "recovery", "s", 0.0, 4 * scales.interval, 0.0, 0.1 * scales.duration, shape=True
        ),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return limits in the upper half of the input's range."""
    return tuple(
        (scales.u_peak - part * scales.u_span, sharpness, 0.0, 1.0, 0.0)
        for part, sharpness in ((0.07, 60.0), (0.2, 30.0), (0.35, 8.0), (0.1, 3.0))
    )


EFFECT = Effect(
    name="input_saturation",
    port=Port.INPUT,
    family=Family.LIMIT,
    symptom="beyond a limit of the input the simulation goes on and the device does not",
    citation="Hu and Lin (2001), Control Systems with Actuator Saturation, chapter 1; "
    "Moll (1954), Proceedings of the IRE 42:1773, on a limit that is left late",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    defining="limit",
)
