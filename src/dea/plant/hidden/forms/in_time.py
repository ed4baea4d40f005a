"""Changes while the experiment runs: drifts of gain and baseline, faults, and disturbances."""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.plant import forces
from dea.plant.array import Array
from dea.plant.film import SUBSTEP
from dea.plant.force_laws import in_time
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import added_course, gain_course
from dea.plant.signal_law import SignalLaw

Course = Callable[[Array], Array]


def _sign(size: float, rng: Generator) -> float:
    """Down or up; a large change is always up, since a large loss of gain leaves no response."""
    return float(rng.choice([-1.0, 1.0])) if size < 0.5 else 1.0


def _exponential(conditions: Conditions, rng: Generator) -> Course:
    """Approach 1 with a time constant of 0.2 to 0.6 durations."""
    time = rng.uniform(0.2, 0.6) * conditions.duration
    return lambda t: -np.expm1(-t / time)


def _root(conditions: Conditions, rng: Generator) -> Course:
    """Rise with the root of time, as diffusion does, to 1 at the end."""
    return lambda t: np.sqrt(t / conditions.duration)


def _logarithm(conditions: Conditions, rng: Generator) -> Course:
    """Rise with the logarithm of time, to 1 at the end."""
    time = rng.uniform(0.01, 0.1) * conditions.duration
    return lambda t: np.log1p(t / time) / np.log1p(conditions.duration / time)


def _wandering(conditions: Conditions, rng: Generator) -> Course:
    """Wander as an integrated Ornstein-Uhlenbeck process; the farthest place is 1 away."""
    points = 4001
    correlation = rng.uniform(0.1, 0.3) * points
    speed, steps = 0.0, rng.standard_normal(points)
    speeds = np.zeros(points)
    for k in range(1, points):
        speed += (steps[k] - speed) / correlation
        speeds[k] = speed
    path = np.cumsum(speeds)
    path /= np.abs(path).max()
    times = np.linspace(0.0, conditions.duration, points)
    return lambda t: np.interp(t, times, path)


def _tide(conditions: Conditions, rng: Generator) -> Course:
    """Swing as a day does: a sine with a period of 1.2 to 3 durations."""
    period = rng.uniform(1.2, 3.0) * conditions.duration
    phase = rng.uniform(0.0, 2.0 * np.pi)
    return lambda t: 0.5 * (np.sin(2.0 * np.pi * t / period + phase) - np.sin(phase))


def _gain(size: float, conditions: Conditions, rng: Generator, course: Course) -> Built:
    height = size * _sign(size, rng)
    law = gain_course(lambda t: height * course(t), conditions.duration, conditions.power)
    return Built(law, {})


@tuning("Dissado and Fothergill, Electrical Degradation in Polymers (1992): exponential ageing")
def ageing_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain approaches another value exponentially."""
    return _gain(size, conditions, rng, _exponential(conditions, rng))


@tuning("Crank, The Mathematics of Diffusion (1975): uptake with the root of time")
def diffusing_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes with the root of time."""
    return _gain(size, conditions, rng, _root(conditions, rng))


@reporting("Struik, Physical Aging in Amorphous Polymers (1978): ageing with the logarithm of time")
def logarithmic_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes with the logarithm of time."""
    return _gain(size, conditions, rng, _logarithm(conditions, rng))


@reporting("Harvey, Forecasting, Structural Time Series Models (1989): an integrated random walk")
def wandering_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain wanders smoothly."""
    return _gain(size, conditions, rng, _wandering(conditions, rng))


def _added(
    size: float, conditions: Conditions, rng: Generator, course: Course, *, output: bool = True
) -> Built:
    reach = conditions.travel if output else conditions.span
    height = size * reach * rng.choice([-1.0, 1.0])
    law = added_course(lambda t: height * course(t), conditions.duration, output=output)
    return Built(law, {})


@tuning("Incropera, Heat and Mass Transfer (2007): a mount that warms up exponentially")
def warming_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves exponentially to another baseline."""
    return _added(size, conditions, rng, _exponential(conditions, rng))


@tuning("Crank, The Mathematics of Diffusion (1975): swelling with the root of time")
def swelling_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves with the root of time."""
    return _added(size, conditions, rng, _root(conditions, rng))


@reporting("Harvey, Forecasting, Structural Time Series Models (1989): an integrated random walk")
def wandering_baseline(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's baseline wanders smoothly."""
    return _added(size, conditions, rng, _wandering(conditions, rng))


@reporting("Carslaw and Jaeger, Conduction of Heat in Solids (1959): a part of a daily swing")
def daily_swing(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's baseline follows a part of a slow sine."""
    return _added(size, conditions, rng, _tide(conditions, rng))


@reporting("Lomnitz, J. Geol. 64 (1956) 473: a load that settles with log time", moving=True)
def settling_load(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A constant force comes with the logarithm of time."""
    height = size * conditions.stiffness * conditions.travel * rng.choice([-1.0, 1.0])
    time = rng.uniform(0.01, 0.1) * conditions.duration
    constants = np.array([height, in_time.LOGARITHM, time, conditions.duration])
    return Built(ForceLaw(forces.FORCE_COURSE, constants, np.zeros(1)), {})


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
    moment, height = _moment(conditions, rng), size * _sign(size, rng)
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
    change = 0.5 * size * _sign(size, rng) * conditions.stiffness
    constants = np.array([change, in_time.SIGMOID, moment, width])
    return Built(ForceLaw(forces.STIFFNESS_COURSE, constants, np.zeros(1)), {"time": moment})


@reporting("Isermann, Fault-Diagnosis Systems (2006): a fault whose consequence settles")
def settling_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain leaves its value at once and settles exponentially at another."""
    width = rng.uniform(0.3, 1.0) * conditions.time
    return _stepping(size, conditions, rng, in_time.SETTLING, width)


@reporting("Basseville and Nikiforov, Detection of Abrupt Changes (1993): a mount that slips")
def slipped_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness, or where nothing moves the gain, changes within one sub-step."""
    moment = _moment(conditions, rng)
    change = 0.5 * size * _sign(size, rng)
    if conditions.force:
        constants = np.array([change * conditions.stiffness, in_time.INSTANT, moment, 1.0])
        return Built(ForceLaw(forces.STIFFNESS_COURSE, constants, np.zeros(1)), {"time": moment})
    return _stepping(size, conditions, rng, in_time.INSTANT, 1.0)


@njit(cache=True)
def _harmonics(c: Array, m: Array, y: Array) -> None:
    """c: frequency, then (height, phase) of every harmonic; added to the signal."""
    count = (c.shape[0] - 1) // 2
    for k in range(y.shape[0]):
        angle = 2.0 * np.pi * c[0] * m[0]
        for i in range(count):
            y[k] += c[1 + 2 * i] * np.sin((i + 1) * angle + c[2 + 2 * i])
        m[0] += SUBSTEP


def _frequency(conditions: Conditions, rng: Generator) -> float:
    """Return a frequency from a fifth of the band to six times it."""
    return float(10.0 ** rng.uniform(-0.7, 0.8) / conditions.time)


def _wave(
    size: float, conditions: Conditions, rng: Generator, heights: Array, *, output: bool = True
) -> Built:
    frequency = _frequency(conditions, rng)
    heights = np.asarray(heights) * size * (conditions.travel if output else conditions.span)
    phases = rng.uniform(0.0, 2.0 * np.pi, heights.size)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=output)
    return Built(law, {"frequency": frequency})


@tuning("Den Hartog, Mechanical Vibrations (1956): the harmonics of a reciprocating machine")
def machine_harmonics(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and two harmonics on the reading."""
    return _wave(size, conditions, rng, np.array([1.0, rng.uniform(0, 0.5), rng.uniform(0, 0.3)]))


@tuning("Mohan, Power Electronics (2003): ripple of a supply on the command")
def supply_ripple(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A fundamental and its second harmonic added to the command."""
    heights = np.array([1.0, rng.uniform(0.0, 0.5)])
    return _wave(size, conditions, rng, heights, output=False)


@njit(cache=True)
def _beat(c: Array, m: Array, y: Array) -> None:
    """Two lines of slightly different frequency."""
    height, first, second, share, phase = c
    for k in range(y.shape[0]):
        y[k] += height * (
            np.sin(2.0 * np.pi * first * m[0] + phase) + share * np.sin(2.0 * np.pi * second * m[0])
        )
        m[0] += SUBSTEP


@reporting("Randall, Vibration-based Condition Monitoring (2011): two machines that beat")
def beating_machines(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A line and a weaker one two to six beats a record away."""
    first = _frequency(conditions, rng)
    second = first + rng.uniform(2.0, 6.0) / conditions.duration
    constants = [
        size * conditions.travel, first, second, rng.uniform(0.2, 0.6), rng.uniform(0, 2 * np.pi)
    ]  # fmt: skip
    return Built(SignalLaw(_beat, constants, output=True), {"frequency": first})


@reporting("Hanselman, Brushless Permanent Magnet Motor Design (2003): cogging", moving=True)
def cogging(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Equal pulses of force, many harmonics of one frequency."""
    from scipy.special import i0e

    frequency = 10.0 ** rng.uniform(-0.7, 0.2) / conditions.time
    narrow = rng.uniform(2.0, 6.0)
    height = size * conditions.stiffness * conditions.travel
    phase = rng.uniform(0.0, 2.0 * np.pi)
    constants = np.array([height, frequency, phase, narrow, i0e(narrow)])
    return Built(ForceLaw(forces.PULSES, constants, np.zeros(1)), {"frequency": frequency})


@reporting("Rao, Mechanical Vibrations (2017): the rectified sine of a loose contact")
def rectified_sine(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The positive half of a sine on the reading, by its first six harmonics."""
    frequency, phase = _frequency(conditions, rng), rng.uniform(0.0, 2.0 * np.pi)
    order = np.arange(1, 7)
    # max(sin, 0) = 1/π + sin/2 - (2/π) Σ cos(2k x)/(4k² - 1)
    even = np.where(order % 2 == 0, -2.0 / np.pi / (order**2 - 1.0 + (order == 1)), 0.0)
    heights = 2.0 * size * conditions.travel * np.where(order == 1, 0.5, even)
    phases = order * phase + np.where(order == 1, 0.0, 0.5 * np.pi)
    pairs = np.column_stack([heights, phases]).ravel()
    law = SignalLaw(_harmonics, np.concatenate([[frequency], pairs]), output=True)
    return Built(law, {"frequency": frequency})


EFFECTS = (
    EffectKind(
        "gain_drift", Port.TIME, 0.002, 1.0, "1",
        (ageing_gain, diffusing_gain, logarithmic_gain, wandering_gain),
    ),
    EffectKind(
        "baseline_drift", Port.TIME, 0.005, 2.0, "travels",
        (warming_mount, swelling_mount, wandering_baseline, daily_swing, settling_load),
    ),
    EffectKind(
        "step_fault", Port.TIME, 0.002, 1.0, "1",
        (abrupt_gain, cracked_spring, settling_gain, slipped_mount),
    ),
    EffectKind(
        "periodic_disturbance", Port.OUTPUT, 0.002, 1.0, "travels",
        (machine_harmonics, supply_ripple, beating_machines, cogging, rectified_sine),
    ),
)  # fmt: skip
