"""A physics simulation of a device."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from dea.errors import InputError
from dea.simulation.force_port import ForcePort
from dea.simulation.input_action import InputAction
from dea.simulation.inputs import Input, each_of
from dea.simulation.interpolation import InputInterpolation
from dea.simulation.parameter import Parameter
from dea.simulation.sensor_filter import SensorFilter
from dea.simulation.signatures import (
    DERIVATIVE,
    DERIVATIVE_OF_SEVERAL,
    OUTPUT,
    OUTPUT_OF_SEVERAL,
    compiled,
)
from dea.simulation.simulation_checks import check
from dea.simulation.state import State


@dataclass(frozen=True)
class Simulation:
    """What is known about a device, and where something could be missing.

    What belongs to an input (its name, unit, offset) is a text or number of one and a tuple of
    several.

    Parameters
    ----------
    derivative
        ``derivative(x, u, p, dx)`` writes dx/dt for the states ``x``, the input ``u`` and the
        parameters ``p``, in the order of ``states`` and ``parameters``. Numba compiles it. Of
        several inputs ``u`` holds one value each, in the order of ``input_name``.
    output
        ``output(x, u, p)`` returns the simulated output.
    drive
        Name of the parameter that scales the action of the input; effects in time scale it. Of
        several inputs one for each, or one that scales them all.
    force_ports
        The state equations that force laws can add to; empty if there are none.
    input_offset_spread
        Prior standard deviation of a constant that is added to the input, in ``input_unit``: an
        amplifier's offset, or a constant load. Its prior mean is zero.
    output_gain_spread
        Prior standard deviation of the sensor's gain about one.
    output_offset_spread
        Prior standard deviation of the sensor's offset about zero, in ``output_unit``.
    accuracy
        Known RMS error of the simulation (in ``output_unit``) due to its own simplifications. A
        diagnosis counts a residual of this size as explained.
    lead_in
        Time (s) for which the first input is held before the record starts, so that the device
        has settled.
    input_interpolation
        What the input does between samples: ``zero`` holds it, as a converter does, ``linear``
        joins samples by straight lines, ``smooth`` suits a band-limited input that is measured.
    action
        The same equations with what the input does computed beforehand, once for each input and
        not in every evaluation of the derivative; none where that would save nothing. With one
        input only.
    input_name
        What the input is called; of several inputs a name for each.
    sensor_filter
        The low-pass that the output is read through, where it is known.
    """

    name: str
    input_unit: str | tuple[str, ...]
    output_unit: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    derivative: Callable[..., Any]
    output: Callable[..., float]
    drive: str | tuple[str, ...]
    force_ports: tuple[ForcePort, ...]
    input_offset_spread: float | tuple[float, ...] = 0.0
    output_gain_spread: float = 0.0
    output_offset_spread: float = 0.0
    accuracy: float = 0.0
    lead_in: float = 0.0
    input_interpolation: InputInterpolation = "zero"
    action: InputAction | None = None
    # Its file; one that is changed in memory has none.
    source: str = field(default="", init=False, compare=False)
    input_name: str | tuple[str, ...] = "input"
    sensor_filter: SensorFilter | None = None

    def __post_init__(self) -> None:
        check(self)

    def interpolated(self, how: InputInterpolation) -> "Simulation":
        """Return the simulation of the same file whose input does that between samples."""
        changed = replace(self, input_interpolation=how)
        object.__setattr__(changed, "source", self.source)
        return changed

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """Every input, in order."""
        units = each_of(self.input_unit)
        spreads = each_of(self.input_offset_spread)
        return tuple(
            Input(name, unit, spread)
            for name, unit, spread in zip(
                each_of(self.input_name),
                units,
                spreads if len(spreads) == len(units) else spreads * len(units),
                strict=True,
            )
        )

    @property
    def drives(self) -> tuple[str, ...]:
        """The parameters that scale the action of the inputs: one for each, or one for all."""
        return each_of(self.drive)

    def drive_of(self, place: int) -> int:
        """Return the number of the drive of an input: one may serve all."""
        return min(place, len(self.drives) - 1)

    @property
    def no_input(self) -> Any:
        """The input where there is none, as the equations take it."""
        return np.zeros(len(self.inputs)) if len(self.inputs) > 1 else np.float64(0.0)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        return tuple(state.name for state in self.states)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def nominal(self) -> np.ndarray:
        """Nominal parameter values."""
        return np.array([parameter.nominal for parameter in self.parameters])

    @cached_property
    def compiled_derivative(self) -> Any:
        """The derivative as a compiled function of the integrator's signature."""
        signature = DERIVATIVE_OF_SEVERAL if len(self.inputs) > 1 else DERIVATIVE
        return self._compile(self.derivative, signature, "derivative")

    @cached_property
    def compiled_output(self) -> Any:
        """The output as a compiled function of the integrator's signature."""
        signature = OUTPUT_OF_SEVERAL if len(self.inputs) > 1 else OUTPUT
        return self._compile(self.output, signature, "output")

    def _compile(self, function: Callable[..., Any], signature: Any, role: str) -> Any:
        from numba.core.errors import NumbaError

        try:
            return compiled(function, signature)
        except NumbaError as error:
            raise self.error(
                f"numba cannot compile it ({str(error).splitlines()[0]})",
                role,
                "Use numbers, arrays and functions of math only",
            ) from error

    def error(self, problem: str, part: str, remedy: str) -> InputError:
        """Return the error of a ``part`` of the simulation."""
        return InputError(
            problem, file=self.source or f"simulation {self.name}", field=part, remedy=remedy
        )
