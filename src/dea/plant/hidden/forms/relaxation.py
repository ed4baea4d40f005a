"""Creep and relaxation by pores, by free volume, by fractions and with the time of the day."""

import numpy as np
from numpy.random import Generator

from dea.plant.film import SUBSTEP
from dea.plant.force_laws.in_time import REDUCED_TIME, RELAXING
from dea.plant.force_laws.viscoelastic import FREE_VOLUME, SPECTRUM
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, reporting


@reporting("Mow et al., J. Biomech. Eng. 102 (1980) 73: a fluid that is pressed out of pores")
def biphasic_layer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twelve equal elements whose times are the slowest over squares, 2 to 20 band periods.

    One band period after a step their force is ``size`` stiffnesses.
    """
    slowest = np.exp(rng.uniform(np.log(2.0), np.log(20.0)))
    times = slowest / np.arange(1.0, 13.0) ** 2
    stiffness = size * conditions.stiffness / np.exp(-1.0 / times).sum()
    shares = -np.expm1(-SUBSTEP / (times * conditions.time))
    pairs = np.column_stack([np.full(12, stiffness), shares]).ravel()
    law = ForceLaw(SPECTRUM, np.append(12.0, pairs), np.full(12, conditions.rest))
    return Built(law, {})


@reporting("Knauss and Emri, Polym. Eng. Sci. 27 (1987) 86: a clock that free volume makes quicker")
def free_volume(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Six equal elements from 0.3 to 100 band periods, which relax more quickly when stretched.

    By a factor exp(2 to 5 times x/(1 + x)) at a stretch x, in units of 0.3 to 1 travels.
    """
    times = 10.0 ** np.linspace(-0.5, 2.0, 6)
    stiffness = size * conditions.stiffness / np.exp(-1.0 / times).sum()
    length, quicker = rng.uniform(0.3, 1.0) * conditions.travel, rng.uniform(2.0, 5.0)
    pairs = np.column_stack([np.full(6, stiffness), SUBSTEP / (times * conditions.time)]).ravel()
    constants = np.concatenate([[6.0, length, conditions.rest, quicker], pairs])
    return Built(ForceLaw(FREE_VOLUME, constants, np.full(6, conditions.rest)), {})


@reporting("Koeller, J. Appl. Mech. 51 (1984) 299: a fractional Maxwell element")
def fractional_maxwell(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes as Mittag-Leffler's function of (t/T)^a, ``size`` at the end.

    T is 0.05 to 0.5 durations; by twenty-eight times from 10^-4 to 10^4 of it.
    """
    order, middle = rng.uniform(0.45, 0.8), rng.uniform(0.05, 0.5) * conditions.duration
    ratios = np.log(10.0) * np.linspace(-4.0, 4.0, 28)
    weights = 1.0 / (np.cosh(order * ratios) + np.cos(order * np.pi))
    times = middle * np.exp(ratios)
    lost = size * conditions.stiffness / (weights @ -np.expm1(-conditions.duration / times))
    constants = [lost, 28.0, *np.column_stack([weights, times]).ravel()]
    return Built(ForceLaw(RELAXING, constants), {})


@reporting(
    "Morland and Lee, Trans. Soc. Rheol. 4 (1960) 233: a time that runs with the temperature"
)
def swinging_temperature(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes exponentially, quickly and slowly in turn, ``size`` at the end.

    The rate swings by 0.6 to 0.95 of its mean, 2 to 4 times in the record.
    """
    time = rng.uniform(0.2, 0.8) * conditions.duration
    frequency, phase = rng.uniform(2.0, 4.0) / conditions.duration, rng.uniform(0.0, 2.0 * np.pi)
    depth = rng.uniform(0.6, 0.95)
    angular = 2.0 * np.pi * frequency
    swung = depth / angular * (np.cos(phase) - np.cos(angular * conditions.duration + phase))
    lost = size * conditions.stiffness / -np.expm1(-(conditions.duration + swung) / time)
    return Built(ForceLaw(REDUCED_TIME, [lost, time, angular, phase, depth]), {})
