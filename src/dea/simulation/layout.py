"""The parameters of a simulation with effects attached: their order, and which of them are free."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.simulation.attached import Attached
from dea.simulation.parameter import (
    INPUT_OFFSET,
    OUTPUT_GAIN,
    OUTPUT_OFFSET,
    TIMING_OFFSET,
    Parameter,
    Scaling,
)
from dea.simulation.places import Places

# Prior spreads that a parameter of the simulation may be from its nominal value.
_REACH = 3.0


@dataclass(frozen=True)
class ParameterLayout:
    """Where each parameter is among the ``values`` of all, and which coordinates a fit may change.

    The values are in the parameters' units. The coordinates are those of the free parameters alone,
    in prior spreads from their prior means.

    Parameters
    ----------
    places
        The simulation, which names its effects.
    attached
        The effects, in the order in which they were attached.
    records
        Number of records, each of which starts in a state of its own.
    timing_spread
        Prior standard deviation (s) of the time by which the output is logged late.
    """

    places: Places
    attached: tuple[Attached, ...]
    records: int
    timing_spread: float

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of simulation, initial state, input, sensor and effects, as in ``values``."""
        own = self.places.simulation
        starts = (
            Parameter(f"{record}initial.{s.name}", s.unit, s.initial, s.spread, at_start=True)
            for record in ("", *(f"record_{k}." for k in range(2, self.records + 1)))
            for s in own.states
        )
        ends = (
            *(
                Parameter(name, each.unit, 0.0, each.offset_spread)
                for name, each in zip(self.input_offsets, own.inputs, strict=True)
            ),
            Parameter(OUTPUT_GAIN, "1", 1.0, own.output_gain_spread),
            Parameter(OUTPUT_OFFSET, own.output_unit, 0.0, own.output_offset_spread),
            Parameter(TIMING_OFFSET, "s", 0.0, self.timing_spread),
        )
        laws = (
            replace(p, name=f"{self.places.label(a)}.{p.name}")
            for a in self.attached
            for p in a.parameters
        )
        return (*own.parameters, *starts, *ends, *laws)

    @property
    def input_offsets(self) -> tuple[str, ...]:
        """The names of the constants that are added to the inputs."""
        inputs = self.places.simulation.inputs
        if len(inputs) == 1:
            return (INPUT_OFFSET,)
        return tuple(f"{INPUT_OFFSET}.{each.name}" for each in inputs)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @cached_property
    def free(self) -> np.ndarray:
        """Indices of the parameters that a fit may change."""
        free = [i for i, p in enumerate(self.parameters) if p.spread > 0]
        return np.array(free, dtype=int)  # an integer array where there is none, too

    @cached_property
    def _nominal(self) -> np.ndarray:
        """Nominal values of all parameters."""
        return np.array([p.nominal for p in self.parameters])

    @cached_property
    def _scaling(self) -> Scaling:
        """Scaling of the free coordinates."""
        return Scaling.of([self.parameters[i] for i in self.free])

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the free coordinates.

        The simulation's own parameters stay within a few spreads of their prior: larger changes
        of known parameters would make up for a missing effect.
        """
        pairs = np.array([self.parameters[i].coordinate_bounds() for i in self.free]).reshape(-1, 2)
        own = ~self.of_laws
        pairs[own] = np.clip(pairs[own], -_REACH, _REACH)
        return pairs[:, 0], pairs[:, 1]

    @cached_property
    def _laws_from(self) -> int:
        """Where in ``values`` the effects' parameters begin."""
        return len(self.parameters) - sum(len(a.parameters) for a in self.attached)

    @cached_property
    def of_sensor(self) -> slice:
        """Where in ``values`` gain, offset and timing of the sensor are."""
        return slice(self._laws_from - 3, self._laws_from)

    @cached_property
    def of_inputs(self) -> slice:
        """Where in ``values`` the constants are that are added to the inputs."""
        end = self.of_sensor.start
        return slice(end - len(self.places.simulation.inputs), end)

    @cached_property
    def of_laws(self) -> np.ndarray:
        """Which free coordinates are the effects', and not the simulation's own."""
        result: np.ndarray = self.free >= self._laws_from
        return result

    @cached_property
    def shapes(self) -> np.ndarray:
        """Which free coordinates only shape a law."""
        return np.array([self.parameters[i].shape for i in self.free])

    @cached_property
    def at_start(self) -> np.ndarray:
        """Which free coordinates belong to the state at the start of the record."""
        return np.array([self.parameters[i].at_start for i in self.free])

    @cached_property
    def events(self) -> np.ndarray:
        """Which free coordinates say when something happened, or how long that took."""
        return np.array([self.parameters[i].event for i in self.free], bool)

    @cached_property
    def instants(self) -> np.ndarray:
        """Which free coordinates say when something happened."""
        # How long it took is positive, and counted by its logarithm.
        lasting = np.array([self.parameters[i].log for i in self.free], bool)
        result: np.ndarray = self.events & ~lasting
        return result

    @cached_property
    def own_of_records(self) -> np.ndarray:
        """Which free coordinates belong to one record: its start, and what happens in it alone."""
        own = np.array([p.at_start for p in self.parameters])
        for a, part in zip(self.attached, self.effect_slices, strict=True):
            own[part] |= not a.effect.transferable
        result: np.ndarray = own[self.free]
        return result

    @cached_property
    def effect_slices(self) -> tuple[slice, ...]:
        """Where in ``values`` each effect's parameters are."""
        position = self._laws_from
        slices = []
        for a in self.attached:
            slices.append(slice(position, position + len(a.parameters)))
            position += len(a.parameters)
        return tuple(slices)

    @cached_property
    def only_read(self) -> np.ndarray:
        """Which free coordinates change the reading alone, and not the motion."""
        sensing = set(range(self.of_sensor.start, self.of_sensor.stop))
        for a, own in zip(self.attached, self.effect_slices, strict=True):
            law = zip(range(own.start, own.stop), self.parameters[own], strict=True)
            sensing.update(index for index, each in law if a.effect.only_reads or each.reads)
        return np.isin(self.free, list(sensing))

    @cached_property
    def shaping(self) -> np.ndarray:
        """Indices of the ``values`` that change the input, its action, or the drive."""
        own = self.places.simulation
        parts = [range(self.of_inputs.start, self.of_inputs.stop)]
        parts += [range(len(own.parameters))] if own.action is not None else []
        for a, law in zip(self.attached, self.effect_slices, strict=True):
            if a.effect.shape_input is not None or a.effect.scale_drive is not None:
                parts.append(range(law.start, law.stop))
        return np.concatenate([np.array(part, dtype=int) for part in parts])

    def values(self, coordinates: np.ndarray) -> np.ndarray:
        """Return all parameter values at free ``coordinates``; known ones stay nominal."""
        result = self._nominal.copy()
        result[self.free] = self._scaling.values(coordinates)
        return result

    @property
    def prior_means(self) -> np.ndarray:
        """All parameter values where the free ones are at their prior means."""
        return self.values(np.zeros(self.free.size))

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Return the free coordinates of parameter ``values``."""
        return np.array([self.parameters[i].coordinate(values[i]) for i in self.free])

    def of_record(self, values: np.ndarray, record: int) -> np.ndarray:
        """Return the values of one record, counted from zero, as if it were the only one."""
        own, states = len(self.places.simulation.parameters), len(self.places.simulation.states)
        start = own + record * states
        laws = (
            a.of_record(values[part], record)
            for a, part in zip(self.attached, self.effect_slices, strict=True)
        )
        ends = values[own + self.records * states : self._laws_from]
        return np.concatenate([values[:own], values[start : start + states], ends, *laws])
