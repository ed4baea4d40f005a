"""Forces that a catalogue of common effects does not hold."""

import numpy as np
from numpy.random import Generator

from dea.plant.force_laws.damping import DRAG, PUMPED, TAPERED
from dea.plant.force_laws.elastic import SNAP_THROUGH
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, foreign, tuning


@tuning(
    "Morison et al., J. Petrol. Technol. 2 (1950) 149: drag with the square of the speed",
    moving=True,
)
def quadratic_drag(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Drag of ``size`` device forces at the mean speed of the motion."""
    constants = [conditions.device_forces(size) / conditions.speed**2]
    return Built(ForceLaw(DRAG, constants), {})


@tuning("Nayfeh and Mook, Nonlinear Oscillations (1979): a stiffness that is pumped", moving=True)
def pumped_stiffness(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A share ``size`` of the stiffness that comes and goes at 0.3 to 5 times the band."""
    frequency = 10.0 ** rng.uniform(-0.5, 0.7) / conditions.time
    constants = [
        size * conditions.stiffness, conditions.rest, frequency, rng.uniform(0.0, 2.0 * np.pi)
    ]  # fmt: skip
    return Built(ForceLaw(PUMPED, constants), {})


@tuning("Virgin, Introduction to Experimental Nonlinear Dynamics (2000): snap-through", moving=True)
def bistable_snap(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A buckled strip whose bistable force reaches about ``size`` device forces.

    It is so narrow that at its middle it takes away two to four times the device's stiffness: there
    the device balances at three places.
    """
    force = conditions.device_forces(size)
    place = conditions.bottom + rng.uniform(0.3, 0.6) * conditions.travel
    width = 2.0 * np.pi * size / rng.uniform(2.0, 4.0) * conditions.travel
    constants = [force, place, width]
    return Built(ForceLaw(SNAP_THROUGH, constants), {})


@tuning("Harris and Crede, Shock and Vibration Handbook (1961): a tapered pin", moving=True)
def tapered_dashpot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A dashpot that grows with a power of 2 to 4 of the place; at the top it is the largest.

    One over the band it is ``size`` stiffnesses there.
    """
    dashpot = size * conditions.stiffness * conditions.time / (2.0 * np.pi)
    constants = [dashpot, conditions.bottom, conditions.travel, rng.uniform(2.0, 4.0)]
    return Built(ForceLaw(TAPERED, constants), {})


EFFECTS = (
    foreign(quadratic_drag, 0.001, 0.3),
    foreign(pumped_stiffness, 0.002, 0.8),
    foreign(bistable_snap, 0.005, 0.12),
    foreign(tapered_dashpot, 0.02, 5.0),
)
