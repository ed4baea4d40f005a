"""Sudden faults."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.force_laws import in_time
from dea.plant.force_laws.hysteresis import JOINT
from dea.plant.force_laws.in_time import DASHPOT_COURSE, FORCE_COURSE, STIFFNESS_COURSE
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import sign
from dea.plant.signal_law import SignalLaw


def _moment(conditions: Conditions, rng: Generator) -> float:
    return float(rng.uniform(0.3, 0.7) * conditions.duration)


@njit(cache=True)
def _stepped(c: Array, m: Array, u: Array) -> None:
    """c: height, shape, moment and width of the step, power of the command in the drive."""
    for k in range(u.shape[0]):
        share = in_time.course(c[1], c[2], c[3], m[0])
        u[k] *= max(1.0 + c[0] * share, 0.0) ** (1.0 / c[4])
        m[0] += SUBSTEP


def _stepping(
    size: float, conditions: Conditions, rng: Generator, shape: int, width: float
) -> Built:
    """Return a step of the gain."""
    moment, height = _moment(conditions, rng), size * sign(size, rng)
    law = SignalLaw(_stepped, [height, shape, moment, width, conditions.power])
    return Built(law, {"time": moment})


@tuning("Gertler, Fault Detection and Diagnosis (1998): an abrupt change, over a short rise")
def abrupt_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes along a short logistic curve."""
    width = rng.uniform(0.02, 0.15) * conditions.time
    return _stepping(size, conditions, rng, in_time.SIGMOID, width)


@tuning("Doebling et al., Shock Vib. Dig. 30 (1998) 91: a sudden loss of stiffness", moving=True)
def cracked_spring(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A part of the stiffness goes, or comes, along a short logistic curve."""
    moment, width = _moment(conditions, rng), rng.uniform(0.02, 0.15) * conditions.time
    change = 0.5 * size * sign(size, rng) * conditions.stiffness
    constants = [change, in_time.SIGMOID, moment, width]
    return Built(ForceLaw(STIFFNESS_COURSE, constants), {"time": moment})


@njit(cache=True)
def _offset(c: Array, m: Array, u: Array) -> None:
    """Add a height c[0] from the moment c[1] on, within c[2] s; the sum is from c[3] to c[4]."""
    for k in range(u.shape[0]):
        added = c[0] * in_time.course(in_time.RAMP, c[1], c[2], m[0])
        if added != 0.0:
            u[k] = min(max(u[k] + added, c[3]), c[4])
        m[0] += SUBSTEP


def _biased(
    height: float, conditions: Conditions, rng: Generator, low: float, high: float, *, output: bool
) -> Built:
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    law = SignalLaw(_offset, [height, moment, width, low, high], output=output)
    return Built(law, {"time": moment})


@tuning("Patton et al., Fault Diagnosis in Dynamic Systems (1989): a sensor with a bias")
def biased_sensor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves by ``size`` travels."""
    height = size * conditions.travel * rng.choice([-1.0, 1.0])
    return _biased(height, conditions, rng, -np.inf, np.inf, output=True)


@tuning("Chen and Patton, Robust Model-Based Fault Diagnosis (1999): an actuator with a bias")
def biased_command(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The command moves by half of ``size`` times its range, and stays within it."""
    height = 0.5 * size * conditions.span * rng.choice([-1.0, 1.0])
    return _biased(height, conditions, rng, conditions.low, conditions.high, output=False)


@njit(cache=True)
def _clearing(c: Array, m: Array, u: Array) -> None:
    """Lose c[0] of the gain at c[1] s; all but a share c[2] of it returns with c[3] s."""
    for k in range(u.shape[0]):
        if m[0] >= c[1]:
            lost = c[0] * (c[2] + (1.0 - c[2]) * np.exp(-(m[0] - c[1]) / c[3]))
            u[k] *= (1.0 - lost) ** (1.0 / c[4])
        m[0] += SUBSTEP


@tuning("Yuan et al., Adv. Mater. 20 (2008) 621: an electrode that clears a breakdown")
def clearing_electrode(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain falls at once, and a part of it returns within about a band period."""
    moment, time = _moment(conditions, rng), rng.uniform(0.3, 1.0) * conditions.time
    constants = [min(size, 0.9), moment, rng.uniform(0.35, 0.7), time, conditions.power]
    return Built(SignalLaw(_clearing, constants), {"time": moment})


@njit(cache=True)
def _rescaled(c: Array, m: Array, y: Array) -> None:
    """Scale by 1 + c[0] about the place c[3] from the moment c[1] on, within c[2] s."""
    for k in range(y.shape[0]):
        y[k] += c[0] * in_time.course(in_time.RAMP, c[1], c[2], m[0]) * (y[k] - c[3])
        m[0] += SUBSTEP


@tuning("Balaban et al., IEEE Sens. J. 9 (2009) 1907: a sensor whose scale changes")
def rescaled_sensor(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's distance from rest becomes 1 + ``size`` or 1 - ``size`` times as large."""
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    constants = [size * sign(size, rng), moment, width, conditions.rest]
    return Built(SignalLaw(_rescaled, constants, output=True), {"time": moment})


@tuning("Gustafsson, Adaptive Filtering and Change Detection (2000): a load jumps", moving=True)
def dropped_load(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A constant force of ``size`` device forces is there from the moment on."""
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    height = conditions.device_forces(size) * rng.choice([-1.0, 1.0])
    law = ForceLaw(FORCE_COURSE, [height, in_time.RAMP, moment, width])
    return Built(law, {"time": moment})


@tuning("Zhang and Jiang, Annu. Rev. Control 32 (2008) 229: an actuator that loses effectiveness")
def lost_effectiveness(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The command's distance from its lowest or its highest becomes 1 - ``size`` of what it was."""
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    stuck = rng.choice([conditions.low, conditions.high])
    law = SignalLaw(_rescaled, [-min(size, 0.9), moment, width, stuck])
    return Built(law, {"time": moment})


@tuning("Isermann, Fault-Diagnosis Applications (2011): oil that has become thick", moving=True)
def thickened_oil(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A dashpot is there from the moment on; one over the band it is ``size`` stiffnesses."""
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    dashpot = size * conditions.stiffness * conditions.time / (2.0 * np.pi)
    law = ForceLaw(DASHPOT_COURSE, [dashpot, in_time.RAMP, moment, width])
    return Built(law, {"time": moment})


@tuning("Isermann, Fault-Diagnosis Systems (2006): a fault whose consequence settles")
def settling_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain leaves its value at once and settles exponentially at another."""
    width = rng.uniform(0.3, 1.0) * conditions.time
    return _stepping(size, conditions, rng, in_time.SETTLING, width)


@tuning("Gaul and Nitsche, Appl. Mech. Rev. 54 (2001) 93: a joint that slips", moving=True)
def slipping_joint(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A joint loses its preload: from then on it slips, by dry friction, where it is stretched."""
    moment = _moment(conditions, rng)
    stretch = rng.uniform(0.05, 0.3) * conditions.travel
    constants = [0.5 * size * conditions.stiffness, moment, stretch, conditions.rest]
    return Built(ForceLaw(JOINT, constants), {"time": moment})


@njit(cache=True)
def _plugged(c: Array, m: Array, y: Array) -> None:
    """A first-order lag of c[1] s from the moment c[0] on; m: time, and value."""
    share = -np.expm1(-SUBSTEP / c[1])
    for k in range(y.shape[0]):
        if m[0] < c[0]:
            m[1] = y[k]
        m[1] += share * (y[k] - m[1])
        y[k] = m[1]
        m[0] += SUBSTEP


@tuning("Lipták, Instrument Engineers' Handbook (2003): a line to a gauge that is plugged")
def plugged_line(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading is late from the moment on, by a lag of ``size`` band periods."""
    moment = _moment(conditions, rng)
    law = SignalLaw(_plugged, [moment, size * conditions.time], [0.0, 0.0], output=True)
    return Built(law, {"time": moment})


@njit(cache=True)
def _blocked(c: Array, m: Array, u: Array) -> None:
    """Clip at c[1] from the moment c[0] on; m: time."""
    for k in range(u.shape[0]):
        if m[0] >= c[0]:
            u[k] = min(u[k], c[1])
        m[0] += SUBSTEP


@tuning("Bartyś et al., Control Eng. Pract. 14 (2006) 577: a valve that no longer opens in full")
def blocked_valve(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The command is limited from the moment on, to 1 - ``size`` of its range."""
    moment, limit = _moment(conditions, rng), conditions.high - min(size, 0.9) * conditions.span
    return Built(SignalLaw(_blocked, [moment, limit]), {"time": moment})


@njit(cache=True)
def _leaking(c: Array, m: Array, u: Array) -> None:
    """Lose c[0] times the root of the command over c[3], from c[1] s on, within c[2] s; m: time."""
    for k in range(u.shape[0]):
        leak = c[0] * in_time.course(in_time.RAMP, c[1], c[2], m[0])
        if u[k] > 0.0:
            u[k] -= min(leak * np.sqrt(u[k] / c[3]), u[k])
        m[0] += SUBSTEP


@reporting("An and Sepehri, Int. J. Fluid Power 6 (2005) 41: an actuator that leaks")
def leaking_actuator(size: float, conditions: Conditions, rng: Generator) -> Built:
    """From the moment on an orifice takes ``size`` of the range away at the highest command.

    At others it takes less, with the root of the command.
    """
    moment, width = _moment(conditions, rng), rng.uniform(0.01, 0.1) * conditions.time
    constants = [size * conditions.span, moment, width, conditions.high]
    return Built(SignalLaw(_leaking, constants), {"time": moment})


@njit(cache=True)
def _intervened(c: Array, m: Array, y: Array) -> None:
    """Add c[0] from c[1] s on, a share c[2] at once and the rest with c[3] s; m: time."""
    for k in range(y.shape[0]):
        if m[0] >= c[1]:
            y[k] += c[0] * (1.0 - (1.0 - c[2]) * np.exp(-(m[0] - c[1]) / c[3]))
        m[0] += SUBSTEP


@reporting("Box and Tiao, J. Am. Stat. Assoc. 70 (1975) 70: a level after an intervention")
def intervened_level(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves by ``size`` travels, 0.3 to 0.7 of it at once, the rest exponentially."""
    moment, time = _moment(conditions, rng), rng.uniform(0.3, 1.0) * conditions.time
    height = size * conditions.travel * rng.choice([-1.0, 1.0])
    constants = [height, moment, rng.uniform(0.3, 0.7), time]
    return Built(SignalLaw(_intervened, constants, output=True), {"time": moment})


EFFECTS = (
    EffectKind(
        "step_fault", Port.TIME, 0.002, 1.0, "1",
        (abrupt_gain, cracked_spring, biased_sensor, biased_command, clearing_electrode,
         rescaled_sensor, dropped_load, lost_effectiveness, thickened_oil, settling_gain,
         slipping_joint, plugged_line, blocked_valve, leaking_actuator, intervened_level),
    ),
)  # fmt: skip
