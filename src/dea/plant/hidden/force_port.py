"""Effects that add a force on the mass."""

import numpy as np
from numpy.random import Generator

from dea.plant import forces
from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Conditions, EffectKind, Port


def viscoelastic_creep(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide power-law relaxation, t to the -``exponent``, of ``size`` film stiffnesses at 1 s.

    A spectrum of eighteen modes, three a decade from 0.03 s to 15 ks, follows the power law
    (Schapery, Polym. Eng. Sci. 9, 1969).
    """
    exponent = rng.uniform(0.1, 0.35)
    times = 0.03 * 10.0 ** (np.arange(18) / 3.0)
    shares = 1.0 - np.exp(-SUBSTEP / times)
    stiffnesses = times**-exponent
    at_one_second = stiffnesses @ np.exp(-1.0 / times)
    stiffnesses *= size * conditions.stiffness / at_one_second
    pairs = np.column_stack([stiffnesses, shares]).ravel()
    memory = np.full(times.size, conditions.rest)
    return ForceLaw(forces.POWER_LAW_CREEP, np.concatenate([[float(times.size)], pairs]), memory)


def rate_independent_hysteresis(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide hysteresis loops that are stiffer at the ends of the travel.

    The initial stiffness is ``size`` film stiffnesses (Masing's rule with Preisach's memory).
    """
    constants = np.array(
        [
            size * conditions.stiffness,
            rng.uniform(0.1, 0.4) * conditions.travel,
            conditions.median,
            rng.uniform(0.8, 2.0) * conditions.travel,
        ]
    )
    memory = np.zeros(forces.WIDTH)
    memory[:2] = 1.0, conditions.rest
    memory[-1] = conditions.rest
    return ForceLaw(forces.MASING_HYSTERESIS, constants, memory)


def coulomb_friction(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide friction of ``size`` times the largest film force, after LuGre.

    Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995: bristles that bend by 2 µm, and
    static friction above sliding friction.
    """
    sliding = size * conditions.stiffness * conditions.travel
    bristle = sliding / 2e-6
    constants = np.array(
        [bristle, 0.01, sliding, sliding * rng.uniform(1.0, 1.4), rng.uniform(0.5e-4, 3e-4)]
    )
    return ForceLaw(forces.LUGRE_FRICTION, constants, np.zeros(1))


def strain_stiffening(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide Fung's exponential force, at the top ``size`` times the largest film force."""
    length = rng.uniform(0.2, 0.5) * conditions.travel
    reach = (conditions.top - conditions.bottom) / length
    force = size * conditions.stiffness * conditions.travel / (np.exp(reach) - 1.0 - reach)
    return ForceLaw(
        forces.FUNG_STIFFENING, np.array([force, length, conditions.bottom]), np.zeros(1)
    )


def cyclic_softening(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide the loss of a share ``size`` of the stiffness with the path travelled.

    A stretched exponential in the accumulated path, as of damage in filled rubber.
    """
    path = rng.uniform(10.0, 60.0) * conditions.travel
    constants = np.array([conditions.stiffness, size, path, rng.uniform(0.6, 0.9)])
    return ForceLaw(forces.PATH_SOFTENING, constants, np.zeros(1))


def second_mode(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide a second mass on a hardening spring of ``size`` film stiffnesses, at 0.6 to 2 Hz."""
    angular = 2.0 * np.pi * rng.uniform(0.6, 2.0)
    spring = size * conditions.stiffness
    mass = spring / angular**2
    dashpot = 2.0 * rng.uniform(0.03, 0.12) * mass * angular
    constants = np.array([mass, spring, dashpot, rng.uniform(1.0, 3.0) * conditions.travel])
    return ForceLaw(forces.ATTACHED_MASS, constants, np.array([conditions.rest, 0.0]))


def end_stop(size: float, conditions: Conditions, rng: Generator) -> ForceLaw:
    """Hide a stop ``size`` of the travel below the top: Hertz contact with damping.

    Hunt and Crossley, J. Appl. Mech. 42, 1975.
    """
    place = conditions.top - size * conditions.travel
    depth = 0.02 * conditions.travel
    stiffness = rng.uniform(5.0, 20.0) * conditions.stiffness / np.sqrt(depth)
    constants = np.array([stiffness, place, rng.uniform(1.0, 20.0)])
    return ForceLaw(forces.HERTZ_STOP, constants, np.zeros(1))


EFFECTS = (
    EffectKind("viscoelastic_creep", Port.FORCE, 0.005, 1.0, "1", viscoelastic_creep),
    EffectKind(
        "rate_independent_hysteresis", Port.FORCE, 0.005, 3.0, "1", rate_independent_hysteresis
    ),
    EffectKind("coulomb_friction", Port.FORCE, 0.002, 0.15, "1", coulomb_friction),
    EffectKind("strain_stiffening", Port.FORCE, 0.01, 4.0, "1", strain_stiffening),
    EffectKind("cyclic_softening", Port.FORCE, 0.002, 0.6, "1", cyclic_softening),
    EffectKind("second_mode", Port.FORCE, 0.002, 2.0, "1", second_mode),
    EffectKind("end_stop", Port.FORCE, 0.02, 0.7, "1", end_stop),
)
