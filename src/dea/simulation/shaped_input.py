"""The input over a record as the laws on its way to the equations shape it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dea.inputs import joined
from dea.simulation.arguments import Course
from dea.simulation.interpolation import at_steps

if TYPE_CHECKING:
    from dea.simulation.extended import ExtendedSimulation


@dataclass(frozen=True, eq=False)
class ShapedInput:
    """The input and the drive over one record, as the laws on their way shape them.

    Most parameters do not change them, and shaping takes up to a third of a run: runs that differ
    in others can share one.

    Parameters
    ----------
    course
        What the integrator takes of them.
    decisive
        The values of all parameters that it depends on.
    table
        What an action makes of the simulation's parameters for its derivative; None where the
        derivative takes the parameters themselves.
    """

    course: Course
    decisive: np.ndarray
    table: np.ndarray | None = None

    @classmethod
    def of(
        cls, extended: "ExtendedSimulation", values: np.ndarray, u: np.ndarray, interval: float
    ) -> "ShapedInput":
        """Return it for the values of all parameters, and an input (n,) or inputs (n, inputs)."""
        own, lead = extended.simulation, extended.lead(interval)
        t = np.arange(len(u)) * interval
        acting = extended.offset(values, u)
        scales = [np.ones(t.size) for _ in own.drives]
        for a, q in extended.laws(values):
            if a.effect.shape_input is not None:
                acting[a.place] = a.effect.shape_input(acting[a.place], q, interval)
            if a.effect.scale_drive is not None:
                drive = own.drive_of(a.place)
                scales[drive] = scales[drive] * a.effect.scale_drive(t, q)
        if lead:
            acting = [np.concatenate([np.full(lead, x[0]), x]) for x in acting]
            scales = [np.concatenate([np.full(lead, x[0]), x]) for x in scales]
        v = joined(acting)
        drive_scale = np.column_stack(scales) if len(acting) > 1 else scales[0]
        substeps = extended.substeps * max([1, *(a.effect.refine for a, _ in extended.pushing)])
        steps = at_steps(v, substeps, extended.input_interpolation)
        table = None
        if own.action:
            p = values[: len(own.parameters)].copy()
            steps = own.action.law(steps, at_steps(drive_scale, substeps, "zero"), p)
            table = own.action.table(p) if own.action.table else None
        straight = int(extended.input_interpolation != "zero")
        course = Course(v, steps, straight, drive_scale, interval, substeps, lead)
        return cls(course, values[extended.layout.shaping], table)

    def serves(self, extended: "ExtendedSimulation", values: np.ndarray) -> bool:
        """Return whether it is also that of other ``values`` of the same simulation."""
        return np.array_equal(values[extended.layout.shaping], self.decisive)
