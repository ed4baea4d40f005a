"""From one instant on the device is driven, or read, otherwise, for good or for a time."""

from itertools import combinations

import numpy as np

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import low_pass
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# Parts of the range of the input that it loses at one end.
_NARROWER = 0.25, 0.6
# Instants at which these are tried, of those at which the residual changes most.
_SHARPEST = 6
# Those of which one may end what another began, and the part that is then taken back.
_ENDING, _BACK = 4, 0.7


def _after(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return how much of every change there is: none, then all, then perhaps a part of it."""
    begun = np.clip(0.5 + (t - q[0]) / q[3], 0.0, 1.0)
    back = -np.expm1(-np.maximum(t - q[0] - q[10], 0.0) / q[11])
    result: np.ndarray = begun * (1.0 - q[12] * back)
    return result


def gain(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the factor on the drive: one, then another value, and perhaps back."""
    result: np.ndarray = np.maximum(1.0 + q[1] * _after(t, q), 1e-3)
    return result


def command(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Keep the input within a range after the same instant, as an actuator that jams does.

    Its ends are those of the input as recorded, which laws and offsets before may have moved.
    """
    least, most = q[6] + u.min() - q[8], q[5] + u.max() - q[9]
    after = _after(interval * np.arange(u.size), q)
    result: np.ndarray = u + after * (np.clip(u, least, most) - u)
    return result


def reading(y: np.ndarray, t: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Shift, scale and smooth the output after the same instant.

    A lag of first order begins at the value that the output then has.
    """
    after = _after(t, q)
    read = y
    if q[7] > 0.0:
        late = low_pass(y, [q[7] / interval, 1.0])
        begun = float(np.interp(q[0], t, y - late))
        late = late + begun * np.exp(-np.maximum(t - q[0], 0.0) / q[7])
        read = y + after * (late - y)
    result: np.ndarray = read + (q[2] + q[4] * read) * after
    return result


def _kept(scales: Scales) -> tuple[float, float, float]:
    """Return how long a change is held, how slowly it is taken back, and of it none."""
    return 0.1 * scales.duration, 0.02 * scales.duration, 0.0


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the instant, the steps of gain, offset and scale, and how long they take.

    Then the range of the input from that instant on, the lag of the reading, the range of the
    record, and how long it is held until a part is taken back, with a time constant.
    """
    dt, duration = scales.interval, scales.duration
    least, most = 0.5 * dt, 0.05 * duration
    low, high, span, unit = scales.u_low, scales.u_high, scales.u_span, scales.u_unit
    # The instant may lie in a block that is left out, where a fit cannot see it.
    likeliest = scales.jumps[0] if scales.jumps else 0.5 * duration
    instant = likeliest, 0.02 * duration, 0.0, duration
    held, back = _kept(scales)[:2]
    return (
        Parameter("instant", "s", *instant, shape=True, event=True),
        Parameter("gain_step", "1", 0.0, 0.1, -0.99, 5.0),
        Parameter("offset_step", scales.y_unit, 0.0, 0.1 * scales.y_span, reads=True),
        Parameter("rise_time", "s", 4 * dt, 1.0, least, most, log=True, shape=True, event=True),
        Parameter("scale_step", "1", 0.0, 0.1, -0.99, 5.0, shape=True, reads=True),
        Parameter("highest_input", unit, high, 0.3 * span, low, high, shape=True),
        Parameter("lowest_input", unit, low, 0.3 * span, low, high, shape=True),
        Parameter("lag", "s", 0.0, 20 * dt, 0.0, 0.2 * duration, shape=True, reads=True),
        Parameter("range_low", unit, low, 0.0),
        Parameter("range_high", unit, high, 0.0),
        Parameter("held_for", "s", held, 1.5, least, duration, log=True, shape=True, event=True),
        Parameter(
            "return_time", "s", back, 1.5, least, 0.2 * duration, log=True, shape=True, event=True
        ),
        Parameter("returned_part", "1", 0.0, 0.3, 0.0, 1.0, shape=True),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return the instants at which the residual changes most, with steps up and down.

    They are of gain or offset alone: of both at once one may make up for what the other explains.
    So are a range of the input that is narrower, at one end, and a lag of the reading. A step up
    may be taken back in part: gradually from its beginning on, or suddenly at another instant.
    """
    rise = 0.01 * scales.duration
    gain, shift = 0.01, 0.01 * scales.y_span
    low, high, span = scales.u_low, scales.u_high, scales.u_span
    whole = high, low, 0.0
    steps = [(gain, 0.0), (-gain, 0.0), (0.0, shift), (0.0, -shift)]
    others = [(high - part * span, low, 0.0) for part in _NARROWER]
    others += [(high, low + part * span, 0.0) for part in _NARROWER]
    others += [(high, low, time) for time in scales.lags[1:]]
    changes = [((step, whole), scales.jumps) for step in steps]
    changes += [(((0.0, 0.0), other), scales.jumps[:_SHARPEST]) for other in others]
    slow, at_once = 0.05 * scales.duration, 0.5 * scales.interval
    first = sorted(scales.jumps[:_ENDING])
    ends = [(start, (at_once, slow, _BACK)) for start in first]
    ends += [(start, (end - start, rise, _BACK)) for start, end in combinations(first, 2)]
    return (
        *(
            (instant, *step, rise, 0.0, *other, low, high, *_kept(scales))
            for (step, other), instants in changes
            for instant in instants
        ),
        *(
            (instant, *step, rise, 0.0, *whole, low, high, *back)
            for step in ((gain, 0.0), (0.0, shift))
            for instant, back in ends
        ),
    )


EFFECT = Effect(
    name="step_fault",
    port=Port.TIME,
    family=Family.EVENT,
    symptom="from one instant on the device responds differently",
    citation="Basseville and Nikiforov (1993), Detection of Abrupt Changes, chapter 2; Zhang and "
    "Jiang (2008), Annual Reviews in Control 32:229, on actuators that jam",
    parameters=parameters,
    starts=starts,
    shape_input=command,
    scale_drive=gain,
    shape_output=reading,
    transferable=False,
    defining="instant",
)
