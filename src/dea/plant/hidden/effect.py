"""The kind of a hidden effect: a port, a range of sizes, and a way to build its law."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from numpy.random import Generator

from dea.plant.rig import Law


class Port(StrEnum):
    """Where a hidden effect acts."""

    INPUT = "input path"
    FORCE = "force balance"
    TIME = "parameter in time"
    OUTPUT = "output path"
    OUTSIDE = "outside"  # anywhere; an effect that a catalogue of common effects does not hold


class Conditions(NamedTuple):
    """The plain actuator under the trial's excitation, from which laws take their sizes.

    ``low`` and ``high`` bound the command (V), ``rest``, ``bottom``, ``median`` and ``top`` are
    displacements (m) of the plain actuator without voltage and its least, median and largest
    under the excitation, ``stiffness`` is the film's (N/m), ``duration`` in s.
    """

    low: float
    high: float
    rest: float
    bottom: float
    median: float
    top: float
    stiffness: float
    duration: float

    @property
    def travel(self) -> float:
        """The range of the displacement in m."""
        return self.top - self.bottom


@dataclass(frozen=True)
class EffectKind:
    """A kind of effect on the actuator or its instruments.

    Attributes
    ----------
    name, port
        The engineer's name of the effect, and where it acts.
    smallest, largest
        Range of sizes, searched on a logarithmic scale.
    unit
        Of the size.
    build
        Returns the law, from size, conditions and a generator that draws the law's shape.
    """

    name: str
    port: Port
    smallest: float
    largest: float
    unit: str
    build: Callable[[float, Conditions, Generator], Law]
