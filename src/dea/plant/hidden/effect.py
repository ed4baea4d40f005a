"""The kind of a hidden effect: a port, a range of sizes, and a way to build its law."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from numpy.random import Generator

from dea.plant.rig import Law


class Conditions(NamedTuple):
    """What an experiment does to the plain actuator, for laws to be sized by.

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
    """Something that can be wrong with the actuator or its instruments.

    Attributes
    ----------
    name, port
        As an engineer would call it, and where it acts; port ``outside`` marks what a catalogue
        of common effects does not hold.
    smallest, largest
        Sizes between which the effect is drawn, searched on a logarithmic scale.
    unit
        Of the size.
    build
        From size, conditions and a generator that draws the law's shape, the law.
    """

    name: str
    port: str
    smallest: float
    largest: float
    unit: str
    build: Callable[[float, Conditions, Generator], Law]
