"""A simulation with effects attached, which is fitted, saved and simulated."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.errors import InputError
from dea.inputs import by_input
from dea.simulation.arguments import Values, Workspace
from dea.simulation.attached import Attached
from dea.simulation.effects import Effect
from dea.simulation.force_slots import ForceSlots
from dea.simulation.integrate import integrate, integrate_several
from dea.simulation.interpolation import InputInterpolation
from dea.simulation.layout import ParameterLayout
from dea.simulation.normalisation import Normalisation
from dea.simulation.places import Places
from dea.simulation.scales import Scales
from dea.simulation.sensor_filter import UNFILTERED
from dea.simulation.shaped_input import ShapedInput
from dea.simulation.signatures import SLOTS
from dea.simulation.simulation import Simulation
from dea.simulation.timing import shifted


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
    def places(self) -> Places:
        """Its force ports and inputs."""
        return Places(self.simulation, self.normalisations)

    @cached_property
    def layout(self) -> ParameterLayout:
        """Its parameters, and those of the effects."""
        return ParameterLayout(self.places, self.attached, self.records, self.timing_spread)

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

    def of_each_record(self, values: np.ndarray) -> list[tuple[slice, np.ndarray]]:
        """Return the samples of each record, and the values of :attr:`alone` for it."""
        if self.records == 1:
            return [(slice(None), values)]
        return [
            (samples, self.layout.of_record(values, record))
            for record, samples in enumerate(samples_of_each(self.lengths))
        ]

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
        each = [own for _, own in self.of_each_record(values)]
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
        for number, (samples, own) in enumerate(self.of_each_record(values)):
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
        return [
            each + added for each, added in zip(inputs, values[self.layout.of_inputs], strict=True)
        ]

    def read(self, output: np.ndarray, values: np.ndarray, interval: float) -> np.ndarray:
        """Return the sensor's reading of an output, shape (n,)."""
        if self.records > 1:
            parts = [
                self.alone.read(output[p], own, interval) for p, own in self.of_each_record(values)
            ]
            return np.concatenate(parts)
        gain, offset, late = values[self.layout.of_sensor]
        y: np.ndarray = gain * shifted(output, late / interval) + offset
        t = np.arange(y.size) * interval
        for a, q in self.laws(values):
            if a.effect.shape_output is not None:
                y = a.effect.shape_output(y, t, q, interval)
        return y

    def laws(self, values: np.ndarray) -> list[tuple[Attached, np.ndarray]]:
        """Return each effect with its parameters, in the order in which they are applied."""
        return [(self.attached[i], values[self.layout.effect_slices[i]]) for i in self.order]

    @cached_property
    def order(self) -> tuple[int, ...]:
        """The numbers of the effects attached, in the order in which they are applied."""
        order: list[int] = []
        for index, each in enumerate(self.attached):
            order.insert(0 if each.upstream else len(order), index)
        return tuple(order)

    @cached_property
    def _drive(self) -> int | np.ndarray:
        """Return where the drive is among the parameters; of several inputs, where each is."""
        own = self.simulation
        found = [own.parameter_names.index(drive) for drive in own.drives]
        return np.array(found) if len(own.inputs) > 1 else found[0]

    @cached_property
    def pushing(self) -> tuple[tuple[Attached, slice], ...]:
        """Return the effects attached that are forces, and where in ``values`` they are."""
        pairs = zip(self.attached, self.layout.effect_slices, strict=True)
        return tuple((a, own) for a, own in pairs if a.effect.force is not None)

    @cached_property
    def _slots(self) -> ForceSlots:
        return ForceSlots(self.simulation, self.normalisations)
