"""An effect as it is attached to a simulation."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.simulation.effects import Effect
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales


@dataclass(frozen=True)
class Attached:
    """An effect with the scales its parameters refer to.

    A force law acts at the simulation's force port number ``place``, a law on the input path or
    one that scales the drive at the input of that number. A law on the input path
    or the output path is applied after those attached earlier, or before them if ``upstream``.
    Of several ``records`` each has its own state at the start, and its own course of what happens
    in one record alone.
    """

    effect: Effect
    scales: Scales
    place: int = 0
    upstream: bool = False
    records: int = 1

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The law's parameters, in its order; then those that each further record has its own."""
        copies = (
            replace(self._law[i], name=f"record_{record}.{self._law[i].name}")
            for record in range(2, self.records + 1)
            for i in self._own
        )
        return (*self._law, *copies)

    @cached_property
    def _law(self) -> tuple[Parameter, ...]:
        return self.effect.parameters(self.scales)

    @cached_property
    def _own(self) -> list[int]:
        """Which of the law's parameters each record has its own."""
        anew = not self.effect.transferable
        return [i for i, p in enumerate(self._law) if p.spread > 0 and (p.at_start or anew)]

    def started(self, law: Sequence[float]) -> np.ndarray:
        """Return all parameter values, where those of each record are those of the ``law``."""
        values = np.asarray(law, float)
        return np.concatenate([values, np.tile(values[self._own], self.records - 1)])

    def of_record(self, values: np.ndarray, record: int) -> np.ndarray:
        """Return the law's parameter values in one record, counted from zero."""
        law = values[: len(self._law)].copy()
        if record:
            first = len(self._law) + (record - 1) * len(self._own)
            law[self._own] = values[first : first + len(self._own)]
        return law
