"""The forces attached to a simulation, as the integrator takes them: one slot each."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.simulation.arguments import Equations, ForceLaw, Forces
from dea.simulation.attached import Attached
from dea.simulation.normalisation import Normalisation
from dea.simulation.signatures import MEMORY, SLOTS, first_class, no_force, no_update
from dea.simulation.simulation import Simulation


@dataclass(frozen=True)
class ForceSlots:
    """The force ports of a simulation, with their units of motion and force."""

    simulation: Simulation
    normalisations: tuple[Normalisation, ...]

    def equations(self, pushing: Sequence[Attached]) -> Equations:
        """Return the compiled functions of the simulation and of the forces attached."""
        own = self.simulation
        laws = [
            ForceLaw(first_class(a.effect.force), first_class(a.effect.update)) for a in pushing
        ]
        empty = ForceLaw(first_class(no_force), first_class(no_update))
        return Equations(
            first_class(own.action.derivative if own.action else own.compiled_derivative),
            first_class(own.compiled_output),
            *laws,
            *[empty] * (SLOTS - len(laws)),
        )

    def forces(self, pushing: Sequence[tuple[Attached, np.ndarray]], p: np.ndarray) -> Forces:
        """Return where each force attached acts, and its numbers, from its parameter values.

        ``p`` are those of the simulation.
        """
        ports, normalisations = np.full((SLOTS + 1, 4), -1), np.ones((SLOTS + 1, 3))
        still = np.zeros(SLOTS, np.int64)
        memory, parameters = np.zeros((SLOTS, MEMORY)), np.zeros((SLOTS, MEMORY))
        if self.simulation.force_ports:
            ports[SLOTS], normalisations[SLOTS] = self._ports[0], self._normalisations[0]
        for slot, (a, q) in enumerate(pushing):
            ports[slot], normalisations[slot] = self._ports[a.place], self._normalisations[a.place]
            divisor = self._divisors[a.place]
            if divisor is not None:
                normalisations[slot, 2] /= p[divisor]
            parameters[slot, : q.size] = q
            # The memory is held during the lead-in, unless the port has no position: there a
            # constant force would keep the device moving, as nothing brings it to rest.
            still[slot] = a.effect.remembers_motion and ports[slot, 1] >= 0
            if a.effect.memory is not None:
                memory[slot] = a.effect.memory(q)
        return Forces(len(pushing), ports, normalisations, still, memory, parameters)

    @cached_property
    def _ports(self) -> np.ndarray:
        names = (None, *self.simulation.state_names)
        return np.array(
            [
                [names.index(name) - 1 for name in (b.equation, b.position, b.velocity, b.reaction)]
                for b in self.simulation.force_ports
            ]
        )

    @cached_property
    def _divisors(self) -> list[int | None]:
        names = self.simulation.parameter_names
        return [
            None if port.divisor is None else names.index(port.divisor)
            for port in self.simulation.force_ports
        ]

    @cached_property
    def _normalisations(self) -> np.ndarray:
        found = self.normalisations or (Normalisation(),) * len(self.simulation.force_ports)
        return np.array([[each.rest, each.scale, each.unit_force] for each in found])
