"""Gain, offset and the scale of the reading change at one instant."""

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


def _after(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    result: np.ndarray = np.clip(0.5 + (t - q[0]) / q[3], 0.0, 1.0)
    return result


def gain(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the factor on the drive: one, then another value."""
    result: np.ndarray = np.maximum(1.0 + q[1] * _after(t, q), 1e-3)
    return result


def reading(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Shift and scale the output from the same instant."""
    result: np.ndarray = y + (q[2] + q[4] * y) * _after(t, q)
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the instant, the steps of gain, offset and scale, and how long they take."""
    dt, duration = scales.interval, scales.duration
    low, high = 0.5 * dt, 0.05 * duration
    # The instant may lie in a block that is left out, where a fit cannot see it.
    likeliest = scales.jumps[0] if scales.jumps else 0.5 * duration
    return (
        Parameter(
            "instant", "s", likeliest, 0.02 * duration, 0.0, duration, shape=True, event=True
        ),
        Parameter("gain_step", "1", 0.0, 0.1, -0.99, 5.0),
        Parameter("offset_step", scales.y_unit, 0.0, 0.1 * scales.y_span),
        Parameter("rise_time", "s", 4 * dt, 1.0, low, high, log=True, shape=True, event=True),
        Parameter("scale_step", "1", 0.0, 0.1, -0.99, 5.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return the instants at which the residual changes most, with steps up and down.

    They are of gain or offset alone: of both at once one may make up for what the other explains.
    """
    rise = 0.01 * scales.duration
    gain, shift = 0.01, 0.01 * scales.y_span
    return tuple(
        (instant, *step, rise, 0.0)
        for instant in scales.jumps
        for step in ((gain, 0.0), (-gain, 0.0), (0.0, shift), (0.0, -shift))
    )


EFFECT = Effect(
    name="step_fault",
    port=Port.TIME,
    family=Family.EVENT,
    symptom="from one instant on the device responds differently",
    citation="Basseville and Nikiforov (1993), Detection of Abrupt Changes, chapter 2",
    parameters=parameters,
    starts=starts,
    scale_drive=gain,
    shape_output=reading,
    transferable=False,
    defining="instant",
)
