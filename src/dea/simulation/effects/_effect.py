"""An effect: a law with bounded parameters that attaches at a port of any simulation."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Literal, NamedTuple

import numpy as np

from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import no_update


class Port(StrEnum):
    """Where an effect attaches."""

    INPUT = "input path"
    FORCE = "force balance"
    TIME = "parameter in time"
    OUTPUT = "output path"


class Family(StrEnum):
    """Families of physics; a record hardly distinguishes effects of the same family."""

    THRESHOLD = "threshold"
    LIMIT = "limit"
    LAG = "lag"
    CURVE = "static curve"
    RELAXATION = "relaxation"
    DISSIPATION = "dissipation"
    AGEING = "slow change"
    EVENT = "event"
    OSCILLATION = "oscillation"


Law = Callable[..., Any]


class Quantity(NamedTuple):
    """What several parameters of a law amount to: ``of(q, scales)``, in the unit of ``like``."""

    name: str
    like: str
    of: Callable[[np.ndarray, Scales], float]


@dataclass(frozen=True)
class Effect:
    """A physical effect of the catalogue.

    Parameters
    ----------
    symptom
        How the effect shows in a record, in a sentence.
    citation
        Where the law comes from.
    parameters
        ``parameters(scales)`` returns the law's parameters, in the order the law takes them.
    starts
        ``starts(scales)`` returns the points from which the law is fitted.
    shape_input
        ``law(u, q, interval)`` returns the input that reaches the device.
    force, update
        ``force(z, w, memory, q)`` in units of the elastic force at z = 1, for the normalised
        position z and velocity w (1/s); ``update(z, z_next, h, memory, q)`` moves its memory on.
    memory
        ``memory(q)`` returns the memory at the start.
    scale_drive
        ``law(t, q)`` returns the factor on the simulation's drive parameter.
    shape_output
        ``law(y, t, q, interval)`` returns what the sensor reports.
    transferable
        Whether it is a property of the device, which holds in other records, too. An event or a
        drift belongs to the record it happened in.
    needs_position
        Whether the force is none without a position, which not every force balance has: the
        integral of a velocity tells distances alone.
    opposes_motion
        Whether the force is one against the motion, wherever that is.
    remembers_motion
        Whether the memory changes with the motion alone, and not with time. What moved before the
        record is not known: such a memory begins with the record, as its start parameters say.
    refine
        How many times finer than the simulation alone the law needs its steps.
    essential
        The parameter at one of whose bounds, ``vanishes_at``, the law is no longer this effect.
    defining
        The parameter that a verdict states first: the size of the effect, its time or its position.
        Empty where several parameters define it together, as those of a curve, or each one does, as
        the positions of two stops.
    quantities
        What a verdict states instead, where single parameters tell nothing.
    relaxed
        ``relaxed(q, times, scales)`` returns the stiffness that a force has lost at times after a
        step, which is shown instead of the force.
    """

    name: str
    port: Port
    family: Family
    symptom: str
    citation: str
    parameters: Callable[[Scales], tuple[Parameter, ...]]
    starts: Callable[[Scales], tuple[tuple[float, ...], ...]]
    shape_input: Law | None = None
    force: Law | None = None
    update: Law = no_update
    memory: Callable[[np.ndarray], np.ndarray] | None = None
    scale_drive: Law | None = None
    shape_output: Law | None = None
    transferable: bool = True
    needs_position: bool = True
    opposes_motion: bool = False
    remembers_motion: bool = False
    refine: int = 1
    essential: str = ""
    vanishes_at: Literal["low", "high"] = "low"
    defining: str = ""
    quantities: tuple[Quantity, ...] = ()
    relaxed: Callable[[np.ndarray, np.ndarray, Scales], np.ndarray] | None = None

    def at_limit(self) -> "Effect":
        """Return the law whose essential parameter, if there is one, is known to be at its bound.

        That parameter may be one that no fit changes, as the law has it.
        """

        def known(each: Parameter) -> Parameter:
            bound = each.low if self.vanishes_at == "low" else each.high
            return replace(each, nominal=bound, spread=0.0)

        def parameters(scales: Scales) -> tuple[Parameter, ...]:
            return tuple(
                known(each) if each.name == self.essential else each
                for each in self.parameters(scales)
            )

        return replace(self, parameters=parameters)

    @property
    def on_input(self) -> bool:
        """Whether the law acts on one of the inputs, or on what it does."""
        return self.shape_input is not None or self.scale_drive is not None

    @property
    def only_reads(self) -> bool:
        """Whether the law changes the reading alone, and not the motion."""
        return self.shape_input is None and self.force is None and self.scale_drive is None

    @property
    def drifts_reading(self) -> bool:
        """Whether the law is a course of the reading in time, as slow noise has it, too."""
        return self.only_reads and self.port is Port.TIME
