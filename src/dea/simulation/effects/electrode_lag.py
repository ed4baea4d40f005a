"""The input charges the device through a resistance."""

import numpy as np
from numba import njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.effects._laws import held_charge, powered, remaining, time_at
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@njit(cache=True, error_model="numpy")
def law(u: np.ndarray, q: np.ndarray, interval: float) -> np.ndarray:
    """Charge the near part of the electrodes through a fast lag, the far part through both lags.

    That is a ladder of two resistances and capacitances: without a near part a cascade, and with a
    near part of at least the lags' ratio the same as two lags in parallel. Its charge at the start
    of the record is unknown. An input of one sign may discharge it through another resistance than
    it charges through. A device that its voltage v stretches has a differential capacity that grows
    with it: the lags are longer by exp(``growth`` v²), v in units of the largest input. With
    ``ringing`` r the near part is charged by (1 + r) u less r times the far charge: both lags are
    then those of a series circuit with an inductance, of equal ones with a damping ratio of
    1/√(1 + r). Where the resistance depends on the voltage across it, the far charge approaches the
    near one as a power ``order`` of their distance, in units of the largest input. While electrodes
    dry, the lags grow in proportion to time, by a part ``ageing`` of those in the middle of a
    ``duration``, and no further; every record begins with electrodes as new.
    """
    middle, ratio, part, start, falling, growth = q[0], q[1], q[2], q[3], q[4], q[5] / (q[6] * q[6])
    ringing, order, ageing = q[7], q[8], q[9]
    result = np.empty(u.size)
    near, far = u[0], u[0] + start
    for k in range(u.size):
        target = u[k]
        slow = middle * (1.0 + ageing * (min((k + 0.5) * interval / q[10], 1.0) - 0.5))
        if ringing > 0.0:
            # The mean far charge of this interval is linear in the target that it sets, or nearly.
            own, _ = remaining(near, target, slow * ratio, falling, growth, interval)
            time = time_at(slow, far - near, q[6], order)
            other, _ = remaining(far, near, time, falling, growth, interval)
            back = near * own * (1.0 - other) + far * other
            passed = (1.0 - own) * (1.0 - other)
            target = ((1.0 + ringing) * u[k] - ringing * back) / (1.0 + ringing * passed)
        near_mean, near = held_charge(near, target, slow * ratio, falling, growth, interval)
        time = time_at(slow, far - near_mean, q[6], order)
        far_mean, far = powered(far, near_mean, time, falling, growth, interval, order)
        result[k] = (1.0 - part) * far_mean + part * near_mean
    return result


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the slow time, the fast one's ratio, the near part, charge at start, how they vary."""
    dt, spread = scales.interval, 0.0 if scales.bipolar else 0.3
    return (
        Parameter("time_constant", "s", 5 * dt, 1.5, 0.1 * dt, 0.2 * scales.duration, log=True),
        Parameter("fast_ratio", "1", 0.1, 0.7, 1e-3, 1.0, log=True, shape=True),
        Parameter("near_weight", "1", 0.1, 0.15, 0.0, 0.9, shape=True),
        Parameter("start_charge", scales.u_unit, 0.0, 0.3 * scales.u_span, at_start=True),
        Parameter("falling_ratio", "1", 1.0, spread, 0.1, 10.0, log=True, shape=True),
        Parameter("growth", "1", 0.0, 1.0, -1.0, 4.0, shape=True),
        Parameter("full_input", scales.u_unit, scales.u_peak, 0.0),
        Parameter("ringing", "1", 0.0, 0.3, 0.0, 3.0, shape=True),
        Parameter("order", "1", 1.0, 0.4, 1.0, 3.0, log=True, shape=True),
        Parameter("ageing", "1", 0.0, 0.5, -1.8, 1.8, shape=True),
        Parameter("duration", "s", scales.duration, 0.0),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return short lags, in a long record a longer one, and two equal lags that ring a little.

    And a growing capacity, a slower discharge, drying, and a long lag of a small part, beside which
    the rest follows nearly at once.
    """
    dt, full, duration = scales.interval, scales.u_peak, scales.duration
    laws = [(time, 1.0, 0.02, 1.0, 0.0, 0.2, 0.0) for time in scales.lags[:3]]
    laws += [(time, 0.1, 0.1, 1.0, 0.0, 0.0, 0.0) for time in scales.lags]
    laws += [(0.3 * dt, 0.1, 0.1, 1.0, 2.0, 0.0, 0.0)]
    if not scales.bipolar:
        laws += [(samples * dt, 0.1, 0.1, 3.0, 0.0, 0.0, 0.0) for samples in (4.0, 16.0)]
    laws += [(0.3 * dt, 0.1, 0.1, 1.0, 0.0, 0.0, 1.0), (scales.slow, 0.1, 0.7, 1.0, 0.0, 0.0, 0.0)]
    return tuple(
        (time, ratio, near, 0.0, falling, growth, full, ringing, 1.0, ageing, duration)
        for time, ratio, near, falling, growth, ringing, ageing in laws
    )


EFFECT = Effect(
    name="electrode_lag",
    port=Port.INPUT,
    family=Family.LAG,
    symptom="the device answers to a smoothed input",
    citation="Graf and Maas (2012), Smart Materials and Structures 21:094001, on electrode "
    "resistance; Horowitz and Hill (2015), The Art of Electronics, on bleeders; Nilsson and Riedel "
    "(2011), Electric Circuits, on inductance in series; Lampert and Mark (1970), Current "
    "Injection in Solids, on currents that are a power of the voltage; Rosset and Shea (2013), "
    "Applied Physics A 110:281, on electrodes that dry",
    parameters=parameters,
    starts=starts,
    shape_input=law,
    defining="time_constant",
)
