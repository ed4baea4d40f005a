"""Hysteresis of leaf springs, of cracked concrete and by an intrinsic time."""

import numpy as np
from numpy.random import Generator

from dea.plant.force_laws.hysteresis import ENDOCHRONIC, LEAVES, PEAKS
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, reporting, tuning


@tuning("Fancher et al., SAE Paper 800905 (1980): leaf springs, whose loops widen with the load")
def leaf_spring(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that approaches one line upwards and another downwards, exponentially.

    Both begin 0.1 to 0.4 travels below the travel, with ``size`` stiffnesses more or less by 0.15
    to 0.4.
    """
    start = conditions.bottom - rng.uniform(0.1, 0.4) * conditions.travel
    stiffness, friction = size * conditions.stiffness, rng.uniform(0.15, 0.4)
    constants = [stiffness, friction, rng.uniform(0.05, 0.2) * conditions.travel, start]
    force = stiffness * max(conditions.rest - start, 0.0)
    return Built(ForceLaw(LEAVES, constants, [force, conditions.rest]), {})


@reporting(
    "Takeda et al., J. Struct. Div. ASCE 96 (1970) 2557: concrete that heads for its largest stroke"
)
def cracked_concrete(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring of ``size`` stiffnesses that yields, is left as steeply, and is soft until its peak.

    From where its force is gone it heads for the farthest place so far on the other side.
    """
    constants = [
        size * conditions.stiffness, rng.uniform(0.08, 0.3) * conditions.travel,
        rng.uniform(0.02, 0.2), conditions.rest,
    ]  # fmt: skip
    return Built(ForceLaw(PEAKS, constants, [0.0, conditions.rest]), {})


@reporting("Valanis, Arch. Mech. 23 (1971) 517: a time that runs with the way, not with the clock")
def endochronic(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Three springs of together ``size`` stiffnesses whose force fades exponentially with the way.

    It fades over 0.03 to 0.1 travels, and over three and nine times as many.
    """
    lengths = rng.uniform(0.03, 0.1) * conditions.travel * np.array([1.0, 3.0, 9.0])
    shares = np.array([4.0, 2.0, 1.0]) / 7.0
    pairs = np.column_stack([size * conditions.stiffness * shares, lengths]).ravel()
    law = ForceLaw(ENDOCHRONIC, np.append(3.0, pairs), [conditions.rest])
    return Built(law, {})
