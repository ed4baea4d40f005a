"""A simulation with effects attached, which is fitted, saved and simulated."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.effect_label import labelled
from dea.errors import InputError
from dea.inputs import by_input
from dea.simulation.arguments import Values, Workspace
from dea.simulation.attached import Attached
from dea.simulation.effects import Effect
from dea.simulation.force_port import ForcePort
from dea.simulation.force_slots import ForceSlots
from dea.simulation.inputs import Input
from dea.simulation.integrate import integrate, integrate_several
from dea.simulation.interpolation import InputInterpolation
from dea.simulation.normalisation import Normalisation
from dea.simulation.parameter import (
    INPUT_OFFSET,
    OUTPUT_GAIN,
    OUTPUT_OFFSET,
    TIMING_OFFSET,
    Parameter,
    Scaling,
)
from dea.simulation.scales import Scales
from dea.simulation.sensor_filter import UNFILTERED
from dea.simulation.shaped_input import ShapedInput
from dea.simulation.signatures import SLOTS
from dea.simulation.simulation import Simulation
from dea.simulation.timing import shifted
from dea.units import product

# Prior spreads that a parameter of the simulation may be from its nominal value.
_REACH = 3.0


def samples_of_each(lengths: Sequence[int]) -> list[slice]:
    """Return the samples of each of several records that follow one another."""
    stops = np.cumsum(lengths)
    return [slice(stop - length, stop) for stop, length in zip(stops, lengths, strict=True)]


@dataclass(frozen=True)
class ExtendedSimulation:
    """A simulation, the effects attached to it, and how finely it is integrated.

    ``timing_spread`` is the prior standard deviation (s) of the time by which the output is logged
    late; zero means that it is known. ``lengths`` are the samples of several records that are
    simulated one after the other, each from a start of its own; a single record may have any
    length. ``interpolation`` says what the input does between samples that were computed, such as
    those at a finer interval; how a recorded input does is part of the simulation.
    """

    simulation: Simulation
    attached: tuple[Attached, ...] = ()
    normalisations: tuple[Normalisation, ...] = ()
    substeps: int = 1
    timing_spread: float = 0.0
    lengths: tuple[int, ...] = ()
    interpolation: InputInterpolation | None = None

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of simulation, initial state, input, sensor and effects, as in ``values``."""
        own = self.simulation
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
            replace(p, name=f"{self.label(a)}.{p.name}")
            for a in self.attached
            for p in a.parameters
        )
        return (*own.parameters, *starts, *ends, *laws)

    @property
    def input_offsets(self) -> tuple[str, ...]:
        """The names of the constants that are added to the inputs."""
        inputs = self.simulation.inputs
        if len(inputs) == 1:
            return (INPUT_OFFSET,)
        return tuple(f"{INPUT_OFFSET}.{each.name}" for each in inputs)

    @property
    def records(self) -> int:
        """Number of records that are simulated."""
        return max(1, len(self.lengths))

    @property
    def input_interpolation(self) -> InputInterpolation:
        """What the input does between samples."""
        return self.interpolation or self.simulation.input_interpolation

    @property
    def as_recorded(self) -> "ExtendedSimulation":
        """The same simulation of samples as they are recorded."""
        return replace(self, interpolation=None)

    @cached_property
    def alone(self) -> "ExtendedSimulation":
        """The same simulation of one record."""
        if not self.lengths:
            return self
        attached = tuple(replace(a, records=1) for a in self.attached)
        return replace(self, attached=attached, lengths=())

    def of_record(self, values: np.ndarray, record: int) -> np.ndarray:
        """Return the parameter values of ``alone`` for one record, counted from zero."""
        own, states = len(self.simulation.parameters), len(self.simulation.states)
        start = own + record * states
        laws = (
            a.of_record(values[part], record)
            for a, part in zip(self.attached, self.effect_slices, strict=True)
        )
        ends = values[own + self.records * states : self._laws_from]
        return np.concatenate([values[:own], values[start : start + states], ends, *laws])

    def each(self, values: np.ndarray) -> list[tuple[slice, np.ndarray]]:
        """Return the samples of each record, and the values of ``alone`` for it."""
        if self.records == 1:
            return [(slice(None), values)]
        return [
            (samples, self.of_record(values, record))
            for record, samples in enumerate(samples_of_each(self.lengths))
        ]

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
    def _of_sensor(self) -> slice:
        """Where in ``values`` gain, offset and timing of the sensor are."""
        return slice(self._laws_from - 3, self._laws_from)

    @cached_property
    def _of_inputs(self) -> slice:
        """Where in ``values`` the constants are that are added to the inputs."""
        end = self._of_sensor.start
        return slice(end - len(self.simulation.inputs), end)

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

    def values(self, coordinates: np.ndarray) -> np.ndarray:
        """Return all parameter values at free ``coordinates``; known ones stay nominal."""
        result = self._nominal.copy()
        result[self.free] = self._scaling.values(coordinates)
        return result

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Return the free coordinates of parameter ``values``."""
        return np.array([self.parameters[i].coordinate(values[i]) for i in self.free])

    def label(self, attached: Attached) -> str:
        """Return an effect's name, with its force port or input where there are several."""
        port = self.force_port_of(attached)
        return labelled(attached.effect.name, port.name) if port else self.name_of(attached)

    def name_of(self, attached: Attached) -> str:
        """Return an effect's name, with the input it acts on where the simulation has several."""
        at = self.input_of(attached)
        return labelled(attached.effect.name, at.name if at else None)

    def input_of(self, attached: Attached) -> Input | None:
        """Return the input that an effect acts on, if the simulation has several."""
        effect = attached.effect
        if not effect.on_input or self.places(effect) < 2:
            return None
        return self.simulation.inputs[attached.place]

    def ports_for(self, effect: Effect) -> list[int]:
        """Return the numbers of the force ports that a force law can act at."""
        ports = enumerate(self.simulation.force_ports)
        return [k for k, port in ports if port.position is not None or not effect.needs_position]

    def places(self, effect: Effect) -> int:
        """Return at how many force ports, or inputs, an effect can act."""
        own = self.simulation
        if effect.force is not None:
            return len(self.ports_for(effect))
        if effect.shape_input is not None:
            return len(own.inputs)
        return len(own.drives) if effect.scale_drive is not None else 1

    def force_port_of(self, attached: Attached) -> ForcePort | None:
        """Return the force port of a force law, if the simulation has several."""
        ports = self.simulation.force_ports
        if attached.effect.force is None or len(ports) < 2:
            return None
        return ports[attached.place]

    def frame_of(self, attached: Attached) -> tuple[Normalisation, str]:
        """Return how the motion that a force law acts on is normalised, and its position's unit."""
        port = self.simulation.force_ports[attached.place]
        return self.normalisations[attached.place], self._length_at(port)

    def own_unit(self, attached: Attached, parameter: Parameter) -> tuple[float, float, str]:
        """Return where a parameter of an effect counts from, what its unit is, and the unit's name.

        Places and lengths of a force law are in the unit of its port's position, or of the integral
        of its velocity. Its forces are in that of the port's equation: that of its state per
        second, times that of the divisor.
        """
        as_it_is = 0.0, 1.0, parameter.unit
        if not parameter.at_port:
            return as_it_is
        port = self.simulation.force_ports[attached.place]
        frame = self.normalisations[attached.place]
        force, length = self._force_at(port), self._length_at(port)
        units = {
            "force": (0.0, frame.unit_force, force),
            "place": (frame.rest, frame.scale, length),
            "length": (0.0, frame.scale, length),
            "rate": (0.0, frame.scale, product(length, below="s")),
            "stiffness": (0.0, frame.unit_force / frame.scale, product(force, below=length)),
        }
        found = units.get(parameter.at_port, as_it_is)
        return found if found[1] else as_it_is

    def force_unit(self, attached: Attached) -> tuple[float, str]:
        """Return the unit of the force of a law at its port: its size and its name.

        Where the port has none, forces are as they are.
        """
        size = self.normalisations[attached.place].unit_force
        port = self.simulation.force_ports[attached.place]
        return (size, self._force_at(port)) if size else (1.0, "1")

    def _length_at(self, port: ForcePort) -> str:
        """Return the unit of a port's position, or of the integral of its velocity."""
        states = {each.name: each.unit for each in self.simulation.states}
        if port.position is not None:
            return states[port.position]
        return product(states[port.velocity or ""], "s")

    def _force_at(self, port: ForcePort) -> str:
        """Return the unit of a port's forces: of its equation, times that of the divisor."""
        states = {each.name: each.unit for each in self.simulation.states}
        divisors = {each.name: each.unit for each in self.simulation.parameters}
        return product(states[port.equation], divisors.get(port.divisor or "", "1"), below="s")

    @property
    def takes_force(self) -> bool:
        """Whether another force can be attached."""
        return len(self.pushing) < SLOTS

    def attach(
        self, effect: Effect, scales: Scales, place: int = 0, upstream: bool = False
    ) -> "ExtendedSimulation":
        """Return this simulation with one effect more, of which at most three may be forces."""
        if effect.force is not None and not self.takes_force:
            raise InputError(
                f"{SLOTS} forces are attached already",
                field="effects",
                remedy="Leave one of them out",
            )
        attached = Attached(effect, scales, place, upstream, self.records)
        return replace(self, attached=(*self.attached, attached))

    def without(self, index: int) -> "ExtendedSimulation":
        """Return this simulation without one of the effects attached."""
        return replace(self, attached=self.attached[:index] + self.attached[index + 1 :])

    def simulate(self, values: np.ndarray, u: np.ndarray, interval: float) -> np.ndarray:
        """Return the free-run output, shape (n,); NaN from where the simulation diverges."""
        return self.read(self.run(values, u, interval)[0], values, interval)

    def run(
        self,
        values: np.ndarray,
        u: np.ndarray,
        interval: float,
        shaped: Sequence[ShapedInput] | None = None,
    ) -> np.ndarray:
        """Return the output behind the sensor's own filter, and the normalised position: (2, n).

        Both are NaN from where the simulation diverges.

        Parameters
        ----------
        values
            Of all parameters, shape (parameters,).
        u
            Input (n,), of several inputs (n, inputs).
        interval
            In s.
        shaped
            Inputs of this simulation and record as :meth:`shaped` returned them for other values.
            Each is used if these values shape it alike.
        """
        lead = self.lead(interval)
        parts = [motion[:, lead:] for motion in self.motions(values, u, interval, shaped)]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

    def lead(self, interval: float) -> int:
        """Return how many samples the first input is held for before a record begins."""
        return round(self.simulation.lead_in / interval)

    def motions(
        self,
        values: np.ndarray,
        u: np.ndarray,
        interval: float,
        shaped: Sequence[ShapedInput] | None = None,
    ) -> list[np.ndarray]:
        """Return what ``run`` does of each record, from the start of its lead-in on."""
        shaped = self.shaped(values, u, interval, shaped)
        each = [own for _, own in self.each(values)]
        return [self.alone._motion(own, s) for own, s in zip(each, shaped, strict=True)]

    def _motion(self, values: np.ndarray, shaped: ShapedInput) -> np.ndarray:
        own, course = self.simulation, shaped.course
        first, states = len(own.parameters), len(own.states)
        p, step = values[:first], course.interval / course.substeps
        workspace = Workspace.of(len(course.u), states)
        run = integrate_several() if len(own.inputs) > 1 else integrate
        run(
            self._slots.equations([a for a, _ in self.pushing]),
            Values(
                parameters=(p if shaped.table is None else shaped.table).copy(),
                initial=values[first : first + states].copy(),
                drive=self._drive,
            ),
            course,
            self._slots.forces([(a, values[law]) for a, law in self.pushing], p),
            own.sensor_filter.over(step) if own.sensor_filter else UNFILTERED,
            workspace,
        )
        return workspace.result

    def shaped(
        self,
        values: np.ndarray,
        u: np.ndarray,
        interval: float,
        known: Sequence[ShapedInput] | None = None,
    ) -> list[ShapedInput]:
        """Return the input of each record as the laws shape it: one ``known``, where it serves."""
        made = []
        for number, (samples, own) in enumerate(self.each(values)):
            if known is not None and known[number].serves(self.alone, own):
                made.append(known[number])
            else:
                made.append(ShapedInput.of(self.alone, own, u[samples], interval))
        return made

    def offset(self, values: np.ndarray, u: np.ndarray) -> list[np.ndarray]:
        """Return each input, shape (n,), with the constant that is added to it.

        Raises
        ------
        InputError
            If ``u`` has not the simulation's inputs.
        """
        inputs = by_input(np.ascontiguousarray(u, dtype=float))
        own = self.simulation
        if len(inputs) != len(own.inputs):
            raise InputError(
                f"it holds {len(inputs)} for {len(own.inputs)} inputs",
                field="u",
                remedy="Give the inputs of the simulation, in its order, as the columns of u",
            )
        return [each + added for each, added in zip(inputs, values[self._of_inputs], strict=True)]

    def read(self, output: np.ndarray, values: np.ndarray, interval: float) -> np.ndarray:
        """Return the sensor's reading of an output, shape (n,)."""
        if self.records > 1:
            parts = [self.alone.read(output[p], own, interval) for p, own in self.each(values)]
            return np.concatenate(parts)
        gain, offset, late = values[self._of_sensor]
        y: np.ndarray = gain * shifted(output, late / interval) + offset
        t = np.arange(y.size) * interval
        for a, q in self.laws(values):
            if a.effect.shape_output is not None:
                y = a.effect.shape_output(y, t, q, interval)
        return y

    @cached_property
    def only_read(self) -> np.ndarray:
        """Which free coordinates change the reading alone, and not the motion."""
        sensing = set(range(self._of_sensor.start, self._of_sensor.stop))
        for a, own in zip(self.attached, self.effect_slices, strict=True):
            law = zip(range(own.start, own.stop), self.parameters[own], strict=True)
            sensing.update(index for index, each in law if a.effect.only_reads or each.reads)
        return np.isin(self.free, list(sensing))

    def laws(self, values: np.ndarray) -> list[tuple[Attached, np.ndarray]]:
        """Return each effect with its parameters, in the order in which they are applied."""
        return [(self.attached[i], values[self.effect_slices[i]]) for i in self.order]

    @cached_property
    def order(self) -> tuple[int, ...]:
        """The numbers of the effects attached, in the order in which they are applied."""
        order: list[int] = []
        for index, each in enumerate(self.attached):
            order.insert(0 if each.upstream else len(order), index)
        return tuple(order)

    @cached_property
    def shaping(self) -> np.ndarray:
        """Indices of the ``values`` that change the input, its action, or the drive."""
        own = self.simulation
        parts = [range(self._of_inputs.start, self._of_inputs.stop)]
        parts += [range(len(own.parameters))] if own.action is not None else []
        for a, law in zip(self.attached, self.effect_slices, strict=True):
            if a.effect.shape_input is not None or a.effect.scale_drive is not None:
                parts.append(range(law.start, law.stop))
        return np.concatenate([np.array(part, dtype=int) for part in parts])

    @cached_property
    def _drive(self) -> int | np.ndarray:
        """Return where the drive is among the parameters; of several inputs, where each is."""
        own = self.simulation
        found = [own.parameter_names.index(drive) for drive in own.drives]
        return np.array(found) if len(own.inputs) > 1 else found[0]

    @cached_property
    def pushing(self) -> tuple[tuple[Attached, slice], ...]:
        """Return the effects attached that are forces, and where in ``values`` they are."""
        pairs = zip(self.attached, self.effect_slices, strict=True)
        return tuple((a, own) for a, own in pairs if a.effect.force is not None)

    @cached_property
    def _slots(self) -> ForceSlots:
        return ForceSlots(self.simulation, self.normalisations)
