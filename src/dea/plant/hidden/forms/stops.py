"""Stops."""

import numpy as np
from numpy.random import Generator

from dea.plant.film import SUBSTEP
from dea.plant.force_laws.contact import (
    CONE,
    CREEPING,
    CUSHION,
    DENTED,
    DISC,
    HERTZ,
    PADDED,
    RUBBER,
    STEPPED,
    WEDGES,
)
from dea.plant.force_laws.kind import Kind
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning


def _stopped(
    kind: Kind, size: float, conditions: Conditions, stiffness: float, *others: float
) -> Built:
    """Return a stop that takes away ``size`` travels, with constants after its place."""
    place = conditions.top - size * conditions.travel
    return Built(ForceLaw(kind, [stiffness, place, *others]), {"limit": place})


@tuning("Hunt and Crossley, J. Appl. Mech. 42 (1975) 440: Hertz contact with damping")
def hertz_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Contact that takes a tenth to four tenths of the device force at 0.02 of the travel."""
    depth = 0.02 * conditions.travel
    stiffness = rng.uniform(5.0, 20.0) * conditions.stiffness / np.sqrt(depth)
    damping = rng.uniform(0.0, 0.2) / conditions.speed
    return _stopped(HERTZ, size, conditions, stiffness, damping)


@tuning("Goldsmith, Impact (1960): a spring and dashpot that never pull")
def sprung_contact(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop of eight to thirty times the device's stiffness, with a dashpot."""
    stiffness = rng.uniform(8.0, 30.0) * conditions.stiffness
    dashpot = rng.uniform(0.0, 0.02) * stiffness * conditions.time
    return _stopped(PADDED, size, conditions, stiffness, dashpot)


@tuning("Shaw and Holmes, J. Sound Vib. 90 (1983) 129: a piecewise linear stop")
def stepped_pad(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A pad two to six times as stiff as the device, and behind it a stop of fifteen to forty."""
    soft, hard = conditions.stiffness * np.array([rng.uniform(2.0, 6.0), rng.uniform(15.0, 40.0)])
    thickness = rng.uniform(0.02, 0.06) * conditions.travel
    return _stopped(STEPPED, size, conditions, soft, thickness, hard)


@tuning("Almen and László, Trans. ASME 58 (1936) 305: disc springs, softer before they are flat")
def disc_springs(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop whose stiffness falls to nearly nothing until the discs are flat."""
    height = rng.uniform(0.02, 0.06) * conditions.travel
    thickness = height / rng.uniform(0.9, 1.35)
    stiffness = rng.uniform(10.0, 30.0) * conditions.stiffness
    flat = 2.0 * stiffness
    return _stopped(DISC, size, conditions, stiffness, height, thickness, flat)


@tuning("Sneddon, Int. J. Eng. Sci. 3 (1965) 47: a cone that is pressed in")
def pressed_cone(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop whose force is the square of the depth, within a few hundredths of the travel."""
    stiffness = rng.uniform(5.0, 20.0) * conditions.stiffness / (0.02 * conditions.travel)
    return _stopped(CONE, size, conditions, stiffness)


@tuning("Walton and Braun, J. Rheol. 30 (1986) 949: a contact that is pressed in for good")
def dented_stop(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop of 5 to 20 device stiffnesses, left along a line 1.3 to 3 times as steep."""
    stiffness = rng.uniform(5.0, 20.0) * conditions.stiffness
    return _stopped(DENTED, size, conditions, stiffness, rng.uniform(1.3, 3.0))


@tuning("Lindley, Engineering Design with Natural Rubber (1974): a bumper")
def rubber_bumper(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A soft bumper that stiffens exponentially within a few hundredths of the travel."""
    depth = rng.uniform(0.01, 0.03) * conditions.travel
    stiffness = rng.uniform(1.0, 4.0) * conditions.stiffness
    return _stopped(RUBBER, size, conditions, stiffness, depth)


@tuning("Andersen, The Analysis and Design of Pneumatic Systems (1967): an air cushion")
def air_cushion(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A cylinder that closes: an adiabatic cushion a tenth of the travel long."""
    length = rng.uniform(0.06, 0.15) * conditions.travel
    stiffness = rng.uniform(1.5, 4.0) * conditions.stiffness
    return _stopped(CUSHION, size, conditions, stiffness, length)


@reporting("Garg and Dukkipati, Dynamics of Railway Vehicle Systems (1984): a buffer of wedges")
def friction_buffer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A stop of 8 to 25 device stiffnesses; on the way back it pushes with 0.2 to 0.5 of that."""
    stiffness, kept = rng.uniform(8.0, 25.0) * conditions.stiffness, rng.uniform(0.2, 0.5)
    return _stopped(WEDGES, size, conditions, stiffness, kept, 3.0)


@reporting("Flügge, Viscoelasticity (1975): a standard solid, here a pad that gives way with time")
def creeping_pad(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A pad of 4 to 10 device stiffnesses, and at first of 2 to 4 times that.

    It relaxes in 0.2 to 2 band periods, and comes back as slowly once it is left.
    """
    lasting, ratio = rng.uniform(4.0, 10.0) * conditions.stiffness, rng.uniform(2.0, 4.0)
    share = -np.expm1(-SUBSTEP / (rng.uniform(0.2, 2.0) * conditions.time))
    return _stopped(CREEPING, size, conditions, lasting, (ratio - 1.0) * lasting, share)


EFFECTS = (
    EffectKind(
        "end_stop", Port.FORCE, 0.02, 0.7, "travels",
        (hertz_contact, sprung_contact, stepped_pad, disc_springs, pressed_cone, dented_stop,
         rubber_bumper, air_cushion, friction_buffer, creeping_pad),
    ),
)  # fmt: skip
