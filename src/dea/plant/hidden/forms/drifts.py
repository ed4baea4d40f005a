"""Drifts of gain and baseline while the experiment runs."""

import numpy as np
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.force_laws import in_time
from dea.plant.force_laws.in_time import FORCE_COURSE
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.courses import (
    Course,
    emptied,
    gamma_process,
    heated_for_a_while,
    regulated,
)
from dea.plant.hidden.forms.kernels import added_course, gain_course, sign


def _exponential(conditions: Conditions, rng: Generator) -> Course:
    """Approach 1 with a time constant of 0.2 to 0.6 durations."""
    time = rng.uniform(0.2, 0.6) * conditions.duration
    return lambda t: -np.expm1(-t / time)


def _root(conditions: Conditions, rng: Generator) -> Course:
    """Rise with the root of time, as diffusion does, to 1 at the end."""
    return lambda t: np.sqrt(t / conditions.duration)


def _line(conditions: Conditions, rng: Generator) -> Course:
    """Rise in a straight line, to 1 at the end."""
    return lambda t: t / conditions.duration


def _logistic(conditions: Conditions, rng: Generator) -> Course:
    """Rise from 0 to nearly 1 along a logistic curve a quarter to a half of the record long."""
    middle = rng.uniform(0.35, 0.65) * conditions.duration
    width = rng.uniform(0.06, 0.12) * conditions.duration

    start = 1.0 / (1.0 + np.exp(middle / width))

    def course(t: Array) -> Array:
        value: Array = 1.0 / (1.0 + np.exp((middle - t) / width)) - start
        return value

    return course


def _passing(conditions: Conditions, rng: Generator) -> Course:
    """Come with one time constant and go with another; the highest value is 1."""
    come, go = conditions.duration * np.array([rng.uniform(0.05, 0.15), rng.uniform(0.3, 0.7)])
    top = np.log(go / come) / (1.0 / come - 1.0 / go)
    highest = np.exp(-top / go) - np.exp(-top / come)
    return lambda t: (np.exp(-t / go) - np.exp(-t / come)) / highest


def _primary_and_secondary(conditions: Conditions, rng: Generator) -> Course:
    """Rise with the cube root of time and in a straight line besides, to 1 at the end."""
    share = rng.uniform(0.3, 0.8)
    return lambda t: (
        share * np.cbrt(t / conditions.duration) + (1 - share) * t / conditions.duration
    )


def _two_parts(conditions: Conditions, rng: Generator) -> Course:
    """Approach 1 quickly, and from there a value between -0.5 and 0.3 slowly."""
    quick, slow = conditions.duration * np.array([rng.uniform(0.03, 0.1), rng.uniform(0.3, 0.6)])
    back = rng.uniform(0.7, 1.5)
    return lambda t: back * np.expm1(-t / slow) - np.expm1(-t / quick)


def _ever_steeper(conditions: Conditions, rng: Generator) -> Course:
    """Rise with a power of time, 1.5 to 3, to 1 at the end."""
    power = rng.uniform(1.5, 3.0)
    return lambda t: (t / conditions.duration) ** power


def _spreading(conditions: Conditions, rng: Generator) -> Course:
    """Rise as 1 - exp(-(t/T)^n) with n from 2 to 3.5."""
    time, order = rng.uniform(0.35, 0.7) * conditions.duration, rng.uniform(2.0, 3.5)
    return lambda t: -np.expm1(-((t / time) ** order))


def _consolidation(conditions: Conditions, rng: Generator) -> Course:
    """Rise with the root of time at first, then exponentially, to 1: diffusion out of a layer."""
    time, order = rng.uniform(0.2, 0.6) * conditions.duration, 2.0 * np.arange(80) + 1.0
    weights = order**-2 / (order**-2).sum()
    return lambda t: -np.expm1(-np.outer(t, order**2) / time) @ weights


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


def _random_walk(conditions: Conditions, rng: Generator) -> Course:
    """Walk by independent steps, four thousand in the record; the farthest place is 1 away."""
    path = np.append(0.0, np.cumsum(rng.standard_normal(4000)))
    path /= np.abs(path).max()
    times = np.linspace(0.0, conditions.duration, path.size)
    return lambda t: np.interp(t, times, path)


def _discharge(conditions: Conditions, rng: Generator) -> Course:
    """Change exponentially at first, then hardly, and as a hyperbola before the end, to 1."""
    whole = rng.uniform(1.05, 1.3) * conditions.duration
    time, share = rng.uniform(0.03, 0.1) * conditions.duration, rng.uniform(0.2, 0.5)
    at_end = conditions.duration / (whole - conditions.duration)

    def course(t: Array) -> Array:
        value: Array = share * -np.expm1(-t / time) + (1.0 - share) * t / (whole - t) / at_end
        return value

    return course


def _through_a_wall(conditions: Conditions, rng: Generator) -> Course:
    """Rise as heat does that arrives through a wall, late and with the root of time, to 1."""
    from scipy.special import erfc

    late = rng.uniform(0.1, 0.6) * conditions.duration

    def course(t: Array) -> Array:
        arrived = erfc(np.sqrt(late / np.maximum(t, 1e-9 * conditions.duration)))
        value: Array = arrived / erfc(np.sqrt(late / conditions.duration))
        return value

    return course


def _tide(conditions: Conditions, rng: Generator) -> Course:
    """Swing as a day does: a sine with a period of 1.2 to 3 durations."""
    period = rng.uniform(1.2, 3.0) * conditions.duration
    phase = rng.uniform(0.0, 2.0 * np.pi)
    return lambda t: 0.5 * (np.sin(2.0 * np.pi * t / period + phase) - np.sin(phase))


def _gain(size: float, conditions: Conditions, rng: Generator, course: Course) -> Built:
    height = size * sign(size, rng)
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


@tuning("Pallás-Areny and Webster, Sensors and Signal Conditioning (2001): a linear drift")
def linear_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes in a straight line."""
    return _gain(size, conditions, rng, _line(conditions, rng))


@tuning("Prout and Tompkins, Trans. Faraday Soc. 40 (1944) 488: an autocatalytic change")
def autocatalytic_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes along a long logistic curve."""
    return _gain(size, conditions, rng, _logistic(conditions, rng))


@tuning("Bateman, Proc. Camb. Philos. Soc. 15 (1910) 423: what forms and decays")
def passing_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes and returns more slowly."""
    return _gain(size, conditions, rng, _passing(conditions, rng))


@tuning("Meeker and Escobar, Statistical Methods for Reliability Data (1998): ever faster wear")
def wearing_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes ever faster, with a power of time."""
    return _gain(size, conditions, rng, _ever_steeper(conditions, rng))


@tuning("Avrami, J. Chem. Phys. 7 (1939) 1103: a transformation that starts and spreads")
def crystallising_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes slowly, then faster, and ends."""
    return _gain(size, conditions, rng, _spreading(conditions, rng))


@tuning("Shepherd, J. Electrochem. Soc. 112 (1965) 657: a battery that is discharged")
def discharging_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes at the beginning and, faster and faster, at the end."""
    return _gain(size, conditions, rng, _discharge(conditions, rng))


@tuning("Struik, Physical Aging in Amorphous Polymers (1978): ageing with the logarithm of time")
def logarithmic_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes with the logarithm of time."""
    return _gain(size, conditions, rng, _logarithm(conditions, rng))


@tuning("Harvey, Forecasting, Structural Time Series Models (1989): an integrated random walk")
def wandering_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain wanders smoothly."""
    return _gain(size, conditions, rng, _wandering(conditions, rng))


@reporting("Van Noortwijk, Reliab. Eng. Syst. Saf. 94 (2009) 2: a gamma process, of small amounts")
def eroding_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain changes by many small amounts of random size, all in one direction."""
    return _gain(size, conditions, rng, gamma_process(conditions, rng))


@reporting("Ogata, Modern Control Engineering (2010): a regulator that swings, here of an oven")
def oven_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The gain goes beyond its end, swings and settles."""
    return _gain(size, conditions, rng, regulated(conditions, rng))


def _added(size: float, conditions: Conditions, rng: Generator, course: Course) -> Built:
    height = size * conditions.travel * rng.choice([-1.0, 1.0])
    law = added_course(lambda t: height * course(t), conditions.duration)
    return Built(law, {})


@tuning("Incropera, Heat and Mass Transfer (2007): a mount that warms up exponentially")
def warming_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves exponentially to another baseline."""
    return _added(size, conditions, rng, _exponential(conditions, rng))


@tuning("Crank, The Mathematics of Diffusion (1975): swelling with the root of time")
def swelling_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves with the root of time."""
    return _added(size, conditions, rng, _root(conditions, rng))


@tuning("Beckwith et al., Mechanical Measurements (1993): a zero that drifts steadily")
def steady_zero(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves in a straight line."""
    return _added(size, conditions, rng, _line(conditions, rng))


@tuning("Andrade, Proc. R. Soc. A 84 (1910) 1: primary and secondary creep of a metal")
def creeping_mount(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves with the cube root of time and in a straight line."""
    return _added(size, conditions, rng, _primary_and_secondary(conditions, rng))


@tuning("Slocum, Precision Machine Design (1992): parts that warm up one after the other")
def differential_expansion(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves one way quickly, and back slowly."""
    return _added(size, conditions, rng, _two_parts(conditions, rng))


@tuning("Terzaghi, Theoretical Soil Mechanics (1943): a layer that consolidates")
def consolidating_bed(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves with the root of time at first, and comes to an end."""
    return _added(size, conditions, rng, _consolidation(conditions, rng))


@tuning("Carslaw and Jaeger, Conduction of Heat in Solids (1959): heat through a thick wall")
def heated_wall(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves late, and then ever more slowly."""
    return _added(size, conditions, rng, _through_a_wall(conditions, rng))


@tuning("IEEE, Standard 952 for fibre optic gyroscopes (1997): a bias that walks at random")
def walking_bias(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's baseline walks at random."""
    return _added(size, conditions, rng, _random_walk(conditions, rng))


@tuning("Harvey, Forecasting, Structural Time Series Models (1989): an integrated random walk")
def wandering_baseline(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's baseline wanders smoothly."""
    return _added(size, conditions, rng, _wandering(conditions, rng))


@tuning("Carslaw and Jaeger, Conduction of Heat in Solids (1959): a part of a daily swing")
def daily_swing(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading's baseline follows a part of a slow sine."""
    return _added(size, conditions, rng, _tide(conditions, rng))


@tuning("Lomnitz, J. Geol. 64 (1956) 473: a load that settles with log time", moving=True)
def settling_load(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A constant force comes with the logarithm of time."""
    height = conditions.device_forces(size) * rng.choice([-1.0, 1.0])
    time = rng.uniform(0.01, 0.1) * conditions.duration
    constants = [height, in_time.LOGARITHM, time, conditions.duration]
    return Built(ForceLaw(FORCE_COURSE, constants), {})


@reporting("Munson et al., Fundamentals of Fluid Mechanics (2002): a reservoir that empties")
def emptying_reservoir(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves with a level that falls as Torricelli's law says, until it is empty."""
    return _added(size, conditions, rng, emptied(conditions, rng))


@reporting("ASHRAE, Handbook of Fundamentals (2001): a room that is heated for a while")
def heated_room(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The reading moves while a heater is on, and back when it is off."""
    return _added(size, conditions, rng, heated_for_a_while(conditions, rng))


EFFECTS = (
    EffectKind(
        "gain_drift", Port.TIME, 0.002, 1.0, "1",
        (ageing_gain, diffusing_gain, linear_gain, autocatalytic_gain, passing_gain,
         wearing_gain, crystallising_gain, discharging_gain, logarithmic_gain, wandering_gain,
         eroding_gain, oven_gain),
    ),
    EffectKind(
        "baseline_drift", Port.TIME, 0.005, 2.0, "travels",
        (warming_mount, swelling_mount, steady_zero, creeping_mount, differential_expansion,
         consolidating_bed, heated_wall, walking_bias, wandering_baseline, daily_swing,
         settling_load, emptying_reservoir, heated_room),
    ),
)  # fmt: skip
