"""Forces of stiffening, softening, a second mass and stops."""

import numpy as np
from numpy.random import Generator

from dea.plant import forces
from dea.plant.force_laws import mode
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning


def _static(kind: int, constants: list[float]) -> Built:
    return Built(ForceLaw(kind, np.array(constants), np.zeros(1)), {})


@tuning("Fung, Biomechanics (1981): an exponential of the stretch")
def fung(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that is exponential, at the top ``size`` times the largest device force."""
    length = rng.uniform(0.2, 0.5) * conditions.travel
    reach = conditions.travel / length
    force = size * conditions.stiffness * conditions.travel / (np.exp(reach) - 1.0 - reach)
    return _static(forces.FUNG, [force, length, conditions.bottom])


@tuning("Ogden, Proc. R. Soc. A 326 (1972) 565: a power of the stretch")
def ogden_term(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that is a power of 3.5 to 6, at the top ``size`` times the largest device force."""
    force = size * conditions.stiffness * conditions.travel
    return _static(
        forces.POWER, [force, rng.uniform(3.5, 6.0), conditions.bottom, conditions.travel]
    )


@reporting("Gent, Rubber Chem. Technol. 69 (1996) 59: limited extensibility")
def gent(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that rises without bound at 1.15 to 1.5 travels."""
    limit = rng.uniform(1.15, 1.5)
    force = size * conditions.stiffness * (1.0 / limit) / (1.0 / (1.0 - limit**-2) - 1.0)
    return _static(forces.GENT, [force * limit, limit * conditions.travel, conditions.bottom])


@reporting("Arruda and Boyce, J. Mech. Phys. Solids 41 (1993) 389, Cohen's inverse Langevin")
def langevin_chain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The force of chains that are stretched out at 1.1 to 1.4 travels."""
    limit = rng.uniform(1.1, 1.4)
    x = 1.0 / limit
    full = limit * (x * (3.0 - x * x) / (1.0 - x * x) / 3.0 - x)
    return _static(
        forces.CHAIN,
        [size * conditions.stiffness / full, limit * conditions.travel, conditions.bottom],
    )


def _cycling(size: float, conditions: Conditions, exponent: float) -> Built:
    constants = [
        conditions.stiffness, size, max(conditions.cycles, 2.0), exponent,
        0.1 * conditions.travel, conditions.travel,
    ]  # fmt: skip
    return Built(ForceLaw(forces.CYCLES, np.array(constants), np.zeros(4)), {})


@tuning("Basquin, Proc. ASTM 10 (1910) 625: a power of the number of cycles")
def power_of_cycles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost grows with the number of cycles to the power 0.25 to 0.6."""
    return _cycling(size, conditions, rng.uniform(0.25, 0.6))


@tuning("Ogden and Roxburgh, Proc. R. Soc. A 455 (1999) 2861: Mullins' effect")
def ogden_roxburgh(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Below its largest past stroke the film is softer by up to a share ``size``."""
    most = 0.5 * conditions.stiffness * (conditions.top - conditions.rest) ** 2
    constants = [
        conditions.stiffness, min(size, 0.9), rng.uniform(0.05, 0.3) * most,
        rng.uniform(0.05, 0.3), conditions.rest,
    ]  # fmt: skip
    return Built(ForceLaw(forces.PSEUDO_ELASTIC, np.array(constants), np.zeros(1)), {})


@reporting("Lemaitre, J. Eng. Mater. Technol. 107 (1985) 83: damage driven by work")
def damage_by_work(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost is a hyperbola of the work done on the film."""
    whole = conditions.stiffness * conditions.path * conditions.travel * 0.5
    work = rng.uniform(0.1, 0.6) * whole
    constants = [conditions.stiffness, size, work, conditions.rest]
    return Built(ForceLaw(forces.WORK, np.array(constants), np.zeros(1)), {})


@reporting("Derham and Thomas, Rubber Chem. Technol. 50 (1977) 397: the logarithm of the cycles")
def logarithm_of_cycles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost grows with the logarithm of the number of cycles."""
    return _cycling(size, conditions, 0.0)


def _second(
    size: float, conditions: Conditions, rng: Generator, shape: float, to_ground: float
) -> Built:
    """Return a second mass at 0.6 to 2 times the band, on a spring of ``size`` stiffnesses."""
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    angular = 2.0 * np.pi * frequency
    spring = size * conditions.stiffness
    mass = spring / angular**2
    dashpot = 2.0 * rng.uniform(0.03, 0.12) * mass * angular
    length = rng.uniform(1.0, 3.0) * conditions.travel
    constants = [mass, spring, dashpot * (1.0 - to_ground), dashpot * to_ground, length, shape]
    law = ForceLaw(forces.MODE, np.array(constants), np.array([conditions.rest, 0.0]))
    return Built(law, {"frequency": frequency})


@tuning("Den Hartog, Mechanical Vibrations (1956): an attached mass, here on a hardening spring")
def hardening_absorber(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a hardening spring, damped against the first."""
    return _second(size, conditions, rng, mode.HARDENING, 0.0)


@tuning("Rivin, Stiffness and Damping in Mechanical Design (1999): a mass damped against both")
def shared_damping(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass whose damping is shared between the first mass and the ground."""
    return _second(size, conditions, rng, mode.HARDENING, rng.uniform(0.3, 0.7))


@reporting("Ren, J. Sound Vib. 245 (2001) 762: an absorber damped to the ground")
def grounded_damper(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a hardening spring, damped against the ground."""
    return _second(size, conditions, rng, mode.HARDENING, 1.0)


@reporting("Ibrahim, Liquid Sloshing Dynamics (2005): a pendulum, softer at large angles")
def sloshing_pendulum(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass that swings as a pendulum."""
    return _second(size, conditions, rng, mode.PENDULUM, 0.0)


def _stop(size: float, conditions: Conditions) -> float:
    return conditions.top - size * conditions.travel


def _stopped(kind: int, place: float, constants: list[float]) -> Built:
    return Built(
        ForceLaw(kind, np.array([constants[0], place, *constants[1:]]), np.zeros(1)),
        {"limit": place},
    )


@tuning("Hunt and Crossley, J. Appl. Mech. 42 (1975) 440: Hertz contact with damping")
def hertz_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Contact stiff enough to take the device force within two hundredths of the travel."""
    depth = 0.02 * conditions.travel
    stiffness = rng.uniform(5.0, 20.0) * conditions.stiffness / np.sqrt(depth)
    speed = conditions.path / conditions.duration
    return _stopped(
        forces.HERTZ, _stop(size, conditions), [stiffness, rng.uniform(0.0, 0.2) / speed]
    )


@tuning("Goldsmith, Impact (1960): a spring and dashpot that never pull")
def sprung_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop of eight to thirty times the device's stiffness, with a dashpot."""
    stiffness = rng.uniform(8.0, 30.0) * conditions.stiffness
    dashpot = rng.uniform(0.0, 0.02) * stiffness * conditions.time
    return _stopped(forces.PADDED, _stop(size, conditions), [stiffness, dashpot])


@reporting("Lindley, Engineering Design with Natural Rubber (1974): a bumper")
def rubber_bumper(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A soft bumper that stiffens exponentially within a few hundredths of the travel."""
    depth = rng.uniform(0.01, 0.03) * conditions.travel
    stiffness = rng.uniform(1.0, 4.0) * conditions.stiffness
    return _stopped(forces.RUBBER, _stop(size, conditions), [stiffness, depth])


@reporting("Andersen, The Analysis and Design of Pneumatic Systems (1967): an air cushion")
def air_cushion(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A cylinder that closes: an adiabatic cushion a tenth of the travel long."""
    length = rng.uniform(0.06, 0.15) * conditions.travel
    stiffness = rng.uniform(1.5, 4.0) * conditions.stiffness
    return _stopped(forces.CUSHION, _stop(size, conditions), [stiffness, length])


EFFECTS = (
    EffectKind(
        "strain_stiffening", Port.FORCE, 0.01, 20.0, "device forces",
        (fung, ogden_term, gent, langevin_chain),
    ),
    EffectKind(
        "cyclic_softening", Port.FORCE, 0.002, 0.8, "1",
        (power_of_cycles, ogden_roxburgh, damage_by_work, logarithm_of_cycles),
    ),
    EffectKind(
        "second_mode", Port.FORCE, 0.002, 2.0, "stiffnesses",
        (hardening_absorber, shared_damping, grounded_damper, sloshing_pendulum),
    ),
    EffectKind(
        "end_stop", Port.FORCE, 0.02, 0.7, "travels",
        (hertz_contact, sprung_contact, rubber_bumper, air_cushion),
    ),
)  # fmt: skip
