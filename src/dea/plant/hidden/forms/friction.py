"""Dry friction."""

import numpy as np
from numpy.random import Generator

from dea.plant.force_laws.friction import (
    AGEING,
    BEARING,
    BELT,
    BONDS,
    COMPOSITE,
    DAHL,
    FADING,
    LORENTZIAN,
    LUGRE,
    RUNNING_IN,
    STRIBECK,
    UNEVEN,
)
from dea.plant.force_laws.kind import Kind
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.memory import sliders


@tuning("Canudas de Wit et al., IEEE Trans. Autom. Control 40 (1995) 419: LuGre")
def lugre(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Bristles that bend by a few thousandths of the travel, with static friction above sliding."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    bend = rng.uniform(1e-3, 4e-3) * conditions.travel
    constants = [
        sliding / bend, 0.0, sliding, sliding * rng.uniform(1.0, 1.4),
        speed * rng.uniform(0.1, 0.4),
    ]  # fmt: skip
    return Built(ForceLaw(LUGRE, constants), {})


def _falling(kind: Kind, size: float, conditions: Conditions, rng: Generator) -> Built:
    """Return friction from 1.1 to 1.6 times the sliding one, which it reaches with the speed."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    static = sliding * rng.uniform(1.1, 1.6)
    constants = [sliding, static, speed * rng.uniform(0.2, 0.8), 0.03 * speed]
    return Built(ForceLaw(kind, constants), {})


@tuning("Armstrong-Hélouvry et al., Automatica 30 (1994) 1083: Tustin's exponential of the speed")
def stribeck_curve(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that falls with the speed, regularised near standstill."""
    return _falling(STRIBECK, size, conditions, rng)


@tuning("Al-Bender et al., IEEE Trans. Autom. Control 50 (2005) 1883: Maxwell slip")
def maxwell_slip(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Four blocks on springs that slip after 0.3 to 3 hundredths of the travel."""
    sliding = conditions.device_forces(size)
    shares = rng.uniform(0.4, 1.0, 4)
    stretches = np.geomspace(0.003, 0.03, 4) * conditions.travel
    return sliders(sliding * shares / shares.sum() / stretches, stretches, conditions)


@tuning("Dieterich, J. Geophys. Res. 84 (1979) 2161: contacts that strengthen as they age")
def ageing_contacts(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that grows with the logarithm of the time of rest, and falls with the speed."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    slip = rng.uniform(0.005, 0.02) * conditions.travel
    constants = [sliding, rng.uniform(0.05, 0.12), slip / speed, slip, 0.03 * speed]
    return Built(ForceLaw(AGEING, constants), {})


@tuning("Harris, Rolling Bearing Analysis (2001): friction in proportion to the load")
def loaded_bearing(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that grows with the place, for the load does."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    growth = rng.uniform(0.6, 1.1)
    low = sliding * (1.0 - 0.5 * growth)
    constants = [low, sliding * growth / conditions.travel, conditions.bottom, 0.03 * speed]
    return Built(ForceLaw(BEARING, constants), {})


@tuning("Hess and Soom, J. Tribol. 112 (1990) 147: a fall with the square of the speed")
def hess_soom(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that falls as 1/(1 + (v/v0)²), regularised near standstill."""
    return _falling(LORENTZIAN, size, conditions, rng)


@tuning("Blau, Tribol. Int. 38 (2005) 1007: surfaces that run in")
def running_in(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that falls with the path, as an exponential of it, to 0.3 to 0.6 of the first."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    length = rng.uniform(0.1, 0.4) * conditions.path
    constants = [sliding, rng.uniform(0.4, 0.7), length, 0.03 * speed]
    return Built(ForceLaw(RUNNING_IN, constants), {})


@tuning("Meriam and Kraige, Engineering Mechanics: Statics (2007): Euler's belt around a post")
def belt_around_post(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A belt that slides on a post, under a load that grows with the place.

    Its tensions on either side have the ratio exp(0.15 to 0.4), whichever side pulls.
    """
    wound, growth = rng.uniform(0.15, 0.4), rng.uniform(0.2, 0.6)
    # Half of what is felt on the way there and back is as large as Coulomb's friction.
    load = conditions.device_forces(size) / np.sinh(wound)
    constants = [
        load * (1.0 - 0.5 * growth), load * growth / conditions.travel, conditions.bottom, wound,
        0.03 * conditions.speed,
    ]  # fmt: skip
    return Built(ForceLaw(BELT, constants), {})


@tuning("Armstrong-Hélouvry, Control of Machines with Friction (1991): friction of uneven gears")
def uneven_gears(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that rises and falls by 0.3 to 0.7 of its mean, every 0.05 to 0.3 travels."""
    depth, period = rng.uniform(0.3, 0.7), rng.uniform(0.05, 0.3) * conditions.travel
    # From the lowest place on, so that it does not depend on where the output has its zero.
    phase = rng.uniform(0.0, 2.0 * np.pi) - 2.0 * np.pi * conditions.bottom / period
    constants = [conditions.device_forces(size), depth, period, phase, 0.03 * conditions.speed]
    return Built(ForceLaw(UNEVEN, constants), {})


@tuning("Dahl, Aerospace Corp. TOR-0158(3107-18) (1968): solid friction")
def dahl(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Dahl's friction, which saturates within about two hundredths of the travel."""
    sliding = conditions.device_forces(size)
    stiffness = sliding / (rng.uniform(0.008, 0.025) * conditions.travel)
    return Built(ForceLaw(DAHL, [sliding, stiffness], [0.0, conditions.rest]), {})


@tuning("Makkar et al., IEEE/ASME AIM (2005) 600: a continuous friction, stronger one way")
def makkar(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Three tanh terms of the speed, and up to a fifth more friction in one direction."""
    sliding, speed = conditions.device_forces(size), conditions.speed
    excess = sliding * rng.uniform(0.1, 0.5)
    steepness = np.array([rng.uniform(15.0, 25.0), rng.uniform(1.0, 3.0), 20.0]) / speed
    uneven = rng.uniform(-0.2, 0.2)
    constants = [excess, steepness[0], steepness[1], sliding, steepness[2], uneven]
    return Built(ForceLaw(COMPOSITE, constants), {})


@reporting("Haessig and Friedland, J. Dyn. Syst. Meas. Control 113 (1991) 354: bonds that break")
def breaking_bonds(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Bonds that stretch by 0.3 to 2 hundredths of the travel, and hold again after every turn.

    They break at 1.15 to 1.5 times the force of sliding.
    """
    sliding = conditions.device_forces(size)
    stretch, excess = rng.uniform(0.003, 0.02) * conditions.travel, rng.uniform(0.15, 0.5)
    constants = [sliding * (1.0 + excess) / stretch, sliding, sliding * (1.0 + excess)]
    return Built(ForceLaw(BONDS, constants, [0.0, conditions.rest]), {})


@reporting("Newcomb and Spurr, Braking of Road Vehicles (1967): a brake that fades when it is hot")
def fading_brake(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Friction that its own heat lessens, by half of 0.5 to 0.9 at the mean speed for long.

    It cools within 2 to 10 band periods.
    """
    sliding, speed = conditions.device_forces(size), conditions.speed
    cooling = rng.uniform(2.0, 10.0) * conditions.time
    constants = [sliding, rng.uniform(0.5, 0.9), cooling, speed, 0.03 * speed]
    return Built(ForceLaw(FADING, constants), {})


EFFECTS = (
    EffectKind(
        "coulomb_friction", Port.FORCE, 0.002, 0.2, "device forces",
        (lugre, stribeck_curve, maxwell_slip, ageing_contacts, loaded_bearing, hess_soom,
         running_in, belt_around_post, uneven_gears, dahl, makkar, breaking_bonds, fading_brake),
    ),
)  # fmt: skip
