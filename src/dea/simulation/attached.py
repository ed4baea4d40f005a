"""An effect as it is attached to a simulation."""

from dataclasses import dataclass
from functools import cached_property

from dea.simulation.effects import Effect
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@dataclass(frozen=True)
class Attached:
    """An effect with the scales its parameters refer to.

    A force law acts at the simulation's force port number ``force_port``. A law on the input path
    or the output path is applied after those attached earlier, or before them if ``upstream``.
    """

    effect: Effect
    scales: Scales
    force_port: int = 0
    upstream: bool = False

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The law's parameters, in its order."""
        return self.effect.parameters(self.scales)
