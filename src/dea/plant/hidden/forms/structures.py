"""Stiffening, softening and second masses of beams, fillers, ropes and absorbers."""

import numpy as np
from numpy.random import Generator

from dea.plant.force_laws import damage
from dea.plant.force_laws.damage import CYCLES, FILLER
from dea.plant.force_laws.elastic import NESTED, WORM
from dea.plant.force_laws.mode import RUBBING, THREE_ELEMENTS
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, reporting, tuning


@reporting("Wahl, Mechanical Springs (1963): nested springs, each longer than the next")
def nested_springs(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Three equal springs that are met one after the other, each in a third of the travel."""
    met = (np.arange(3.0) + rng.uniform(0.3, 0.9, 3)) / 3.0
    stiffness = size * conditions.stiffness / (1.0 - met).sum()
    places = conditions.bottom + met * conditions.travel
    return Built(ForceLaw(NESTED, [stiffness, *places]), {})


@reporting("Marko and Siggia, Macromolecules 28 (1995) 8759: a worm-like chain")
def worm_like_chain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The force of a bent chain, straight at 1.1 to 1.4 travels, less its first stiffness."""
    length = rng.uniform(1.1, 1.4) * conditions.travel
    whole = WORM.static([1.0, length, conditions.bottom], conditions.top)
    constants = [conditions.device_forces(size) / whole, length, conditions.bottom]
    return Built(ForceLaw(WORM, constants), {})


@reporting(
    "Kraus, J. Appl. Polym. Sci. Appl. Polym. Symp. 39 (1984) 75: filler that breaks and joins"
)
def filler_network(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Contacts that motion breaks and that join again with time, within 0.2 to 1 durations.

    Motion breaks them on a path of 0.1 to 0.5 of all; ``size`` of the stiffness is lost at the end
    of a steady motion.
    """
    path, joined = rng.uniform(0.1, 0.5) * conditions.path, rng.uniform(0.2, 1.0)
    breaking, joining = conditions.path / path, 1.0 / joined
    both = breaking + joining
    lost = size / (breaking / both * -np.expm1(-both))
    constants = [conditions.stiffness, lost, path, joined * conditions.duration]
    return Built(ForceLaw(FILLER, constants), {})


@tuning("Weibull, J. Appl. Mech. 18 (1951) 293: strands of a rope that break one after the other")
def breaking_strands(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost rises as 1 - exp(-(n/N)^b) with the cycles n, b from 2 to 4.

    N is 0.4 to 0.8 of all cycles.
    """
    constants = [
        conditions.stiffness, size, max(conditions.full_cycles, 1.0), rng.uniform(2.0, 4.0),
        0.1 * conditions.travel, conditions.travel, float(damage.WEIBULL), rng.uniform(0.4, 0.8),
    ]  # fmt: skip
    return Built(ForceLaw(CYCLES, constants), {})


@reporting("Manson and Halford, Int. J. Fract. 17 (1981) 169: slow damage, then quick damage")
def two_phases(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost is a line up to 0.3 to 0.7 of the cycles, and a steeper one from there.

    The first phase takes 0.1 to 0.25 of the loss.
    """
    constants = [
        conditions.stiffness, size, max(conditions.full_cycles, 1.0), rng.uniform(0.3, 0.7),
        0.1 * conditions.travel, conditions.travel, float(damage.PHASES), rng.uniform(0.1, 0.25),
    ]  # fmt: skip
    return Built(ForceLaw(CYCLES, constants), {})


@reporting(
    "Ricciardelli and Vickery, Earthq. Eng. Struct. Dyn. 28 (1999) 685: an absorber that rubs"
)
def rubbing_absorber(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass with dry friction against the first, of 0.01 to 0.04 travels of its spring."""
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    angular, spring = 2.0 * np.pi * frequency, size * conditions.stiffness
    mass = spring / angular**2
    dry = rng.uniform(0.01, 0.04) * spring * conditions.travel
    constants = [
        mass, spring, 0.02 * mass * angular, dry, 0.01 * angular * conditions.travel
    ]  # fmt: skip
    law = ForceLaw(RUBBING, constants, [conditions.rest])
    return Built(law, {"frequency": frequency})


@reporting("Asami and Nishihara, J. Vib. Acoust. 121 (1999) 334: an absorber of three elements")
def three_elements(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a spring of ``size`` stiffnesses, beside it a spring on a dashpot.

    That spring is 0.1 to 0.4 of the other, and relaxes in 0.3 to 1.5 of one over the angular
    frequency.
    """
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    share, relaxed = rng.uniform(0.1, 0.4), rng.uniform(0.3, 1.5)
    # With the first mass held: (s + 1/r)(s² + 1) + share s, in units of mass and spring alone.
    roots = np.roots([1.0, 1.0 / relaxed, 1.0 + share, 1.0 / relaxed])
    turned = float(np.abs(roots[np.argmax(roots.imag)]))
    angular, spring = 2.0 * np.pi * frequency / turned, size * conditions.stiffness
    constants = [
        spring / angular**2, spring, share * spring, share * spring * relaxed / angular
    ]  # fmt: skip
    law = ForceLaw(THREE_ELEMENTS, constants, [conditions.rest])
    return Built(law, {"frequency": frequency})
