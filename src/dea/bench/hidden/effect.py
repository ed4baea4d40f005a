"""What an effect is to the bench: a place, a range of sizes, and a way to build its law."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.bench.forces import ForceLaw

Array = NDArray[np.float64]


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


class Stage:
    """A law on a signal at the sub-step rate: a kernel with its constants and its memory.

    The kernel changes the signal in place and carries the memory, so that the outcome does not
    depend on how the signal is cut. ``output`` says whether the signal is the measured
    displacement (m) or the command before the amplifier (V).
    """

    def __init__(
        self,
        kernel: Callable[[Array, Array, Array], None],
        constants: list[float] | Array,
        memory: list[float] | Array = (0.0,),  # type: ignore[assignment]
        *,
        output: bool = False,
    ) -> None:
        self.output = output
        self._kernel = kernel
        self._constants = np.array(constants, dtype=np.float64)
        self._memory = np.array(memory, dtype=np.float64)

    def advance(self, signal: Array) -> None:
        """Apply the law to the next piece of the signal, in place."""
        self._kernel(self._constants, self._memory, signal)


Law = Stage | ForceLaw


@dataclass(frozen=True)
class Effect:
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
    build: Callable[[float, Conditions, np.random.Generator], Law]
