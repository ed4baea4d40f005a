"""A physics simulation of a device."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np

from dea.errors import InputError
from dea.simulation.equations import beyond, raising, returning
from dea.simulation.force_port import ForcePort
from dea.simulation.input_action import InputAction
from dea.simulation.inputs import RESERVED, Input
from dea.simulation.interpolation import INTERPOLATIONS, InputInterpolation
from dea.simulation.parameter import Parameter
from dea.simulation.sensor_filter import SensorFilter
from dea.simulation.signatures import (
    DERIVATIVE,
    DERIVATIVE_OF_SEVERAL,
    OUTPUT,
    OUTPUT_OF_SEVERAL,
    compiled,
)
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
    source: str = field(default="", compare=False)
    input_name: str | tuple[str, ...] = "input"
    sensor_filter: SensorFilter | None = None

    def __post_init__(self) -> None:
        names = [state.name for state in self.states] + [p.name for p in self.parameters]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise self._error(
                f"two states or parameters are called {doubled[0]!r}", "parameters", "Rename one"
            )
        self._check_inputs()
        self._check_numbers()
        for drive in self.drives:
            if drive not in self.parameter_names:
                raise self._error(
                    f"the drive names {drive!r}, which is no parameter",
                    "drive",
                    f"Name the parameter that scales the input: {', '.join(self.parameter_names)}",
                )
        if self.input_interpolation not in INTERPOLATIONS:
            raise self._error(
                f"there is no input interpolation {self.input_interpolation!r}",
                "input_interpolation",
                f"Choose from {', '.join(INTERPOLATIONS)}",
            )
        through = self.sensor_filter
        if through and not (0.0 < through.cutoff < np.inf and through.order >= 1):
            raise self._error(
                f"there is no low-pass of order {through.order} and {through.cutoff} Hz",
                "sensor_filter",
                "Give a finite cutoff above 0 Hz and an order of at least 1, or leave it out",
            )
        for port in self.force_ports:
            self._check_force_port(port)
        dx = np.full(len(self.states), np.nan)
        x = np.array([state.initial for state in self.states])
        p = self.nominal
        self._check_indices(x, p)
        self.compiled_derivative(x, self.no_input, p, dx)
        y = self.compiled_output(x, self.no_input, p)
        if not (np.isfinite(dx).all() and np.isfinite(y)):
            bad = [
                s.name for s, value in zip(self.states, dx, strict=True) if not np.isfinite(value)
            ]
            raise self._error(
                f"at the nominal parameters and no input the {'derivative' if bad else 'output'} "
                f"{'of ' + ', '.join(bad) + ' ' if bad else ''}is not a number",
                "derivative" if bad else "output",
                "Check its equations and the nominal values",
            )

    def _check_inputs(self) -> None:
        """Check that every input has what belongs to it."""
        several = isinstance(self.input_unit, tuple)
        count = len(_each(self.input_unit))
        for role, shared in (
            ("input_unit", False),
            ("input_name", False),
            ("drive", True),
            ("input_offset_spread", True),
        ):
            given = getattr(self, role)
            fits = isinstance(given, tuple) is several or (several and shared)
            if not fits or (isinstance(given, tuple) and len(given) != max(count, 2)):
                raise self._error(
                    f"it holds {len(_each(given))} for {count} input{'s' * (count > 1)}",
                    role,
                    "Give a tuple with one for each of several inputs; of one input no tuple",
                )
        for role, names in (("input_name", _each(self.input_name)), ("drive", self.drives)):
            if len(set(names)) < len(names):
                raise self._error(
                    f"two inputs have {max(names, key=names.count)!r}",
                    role,
                    "Give each its own" + ", or name one drive for all" * (role == "drive"),
                )
        for name in _each(self.input_name):
            if any(character in name for character in RESERVED):
                raise self._error(
                    f"the name {name!r} holds one of {' '.join(RESERVED)}",
                    "input_name",
                    "Leave these out: they separate effects and their places",
                )
        if several and self.action is not None:
            raise self._error(
                "an action supports one input only, and there are several",
                "action",
                "Leave it out",
            )

    def _check_numbers(self) -> None:
        """Check that deviations, errors and times are finite and not negative, and bounds hold."""

        def possible(value: Any) -> bool:
            return isinstance(value, Real) and 0.0 <= float(value) < np.inf

        spreads = ("input_offset_spread", "output_gain_spread", "output_offset_spread")
        for role in (*spreads, "accuracy", "lead_in"):
            for value in _each(getattr(self, role)):
                if not possible(value):
                    raise self._error(
                        f"it is {value!r}", role, "Give a finite number that is not negative"
                    )
        for state in self.states:
            if not possible(state.spread):
                raise self._error(
                    f"it is {state.spread!r}",
                    f"states.{state.name}.spread",
                    "Give a finite deviation that is not negative",
                )
        for own in self.parameters:
            if not own.low <= own.nominal <= own.high:
                raise self._error(
                    f"it is {own.nominal:g}, and its bounds are {own.low:g} and {own.high:g}",
                    f"parameters.{own.name}.nominal",
                    "Give a value within its bounds",
                )

    def _check_force_port(self, port: ForcePort) -> None:
        for role in ("equation", "position", "velocity", "reaction"):
            name = getattr(port, role)
            if name not in self.state_names and not (name is None and role != "equation"):
                raise self._error(
                    f"a force port names {name!r}, which is no state",
                    f"force_ports.{role}",
                    f"Name one of the states {', '.join(self.state_names)}",
                )
        if port.divisor is not None and port.divisor not in self.parameter_names:
            raise self._error(
                f"a force port names {port.divisor!r}, which is no parameter",
                "force_ports.divisor",
                f"Name one of the parameters {', '.join(self.parameter_names)}",
            )
        if port.divisor is not None and port.reaction is not None:
            raise self._error(
                "a force port has a divisor and a reaction, whose equation may have another one",
                "force_ports",
                "Leave one of them out",
            )
        if port.position is None and port.velocity is None:
            raise self._error(
                "a force port has neither position nor velocity",
                "force_ports",
                "Name the state that moves",
            )

    def _check_indices(self, x: np.ndarray, p: np.ndarray) -> None:
        """Read both equations, and run them uncompiled once: compiled ones check no indices."""
        several = f" of {len(self.inputs)} inputs" * (len(self.inputs) > 1)
        states = "is 1 state" if x.size == 1 else f"are {x.size} states"
        parameters = "1 parameter" if p.size == 1 else f"{p.size} parameters"
        remedy = f"There {states} and {parameters}{several}, counted from 0"
        for function, role, own in (
            (self.derivative, "derivative", (np.empty_like(x),)),
            (self.output, "output", ()),
        ):
            self._check_arguments(function, role, ("x", "u", "p", "dx")[: 3 + len(own)])
            undeclared = beyond(function, (x.size, len(self.inputs), p.size, x.size))
            if undeclared:
                raise self._error(
                    f"it uses a state or parameter that is not declared ({undeclared})",
                    role,
                    remedy,
                )
            returned = returning(function) if own else None
            if returned:
                raise self._error(
                    f"it returns a value ({returned})",
                    role,
                    f"Write the rates into its last argument: dx[0] to dx[{x.size - 1}]",
                )
            exception = raising(function)
            if exception:
                raise self._error(
                    f"it raises an exception ({exception}), which compiled code cannot",
                    role,
                    "Give a value that is not a number instead: such a run counts as unstable",
                )
            try:
                with np.errstate(all="ignore"):
                    plain = getattr(function, "py_func", function)
                    plain(x.copy(), self.no_input, p.copy(), *own)
            except IndexError as error:
                raise self._error(
                    f"it uses a state or parameter that is not declared ({error})", role, remedy
                ) from error
            except (ArithmeticError, ValueError, NameError, TypeError):
                # Compiled, these give infinities or NaN, or the compiler refuses them.
                continue

    def _check_arguments(self, function: Any, role: str, names: tuple[str, ...]) -> None:
        """Check that a function can be called with as many arguments as there are names."""
        if not callable(function):
            problem = f"it is {type(function).__name__}, no function"
        else:
            takes = inspect.signature(getattr(function, "py_func", function))
            try:
                takes.bind(*names)
            except TypeError:
                count = len(takes.parameters)
                problem = f"it takes {count} argument{'s' * (count != 1)}"
            else:
                return
        raise self._error(problem, role, f"Give a function {role}({', '.join(names)})")

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """Every input, in order."""
        units = _each(self.input_unit)
        spreads = _each(self.input_offset_spread)
        return tuple(
            Input(name, unit, spread)
            for name, unit, spread in zip(
                _each(self.input_name),
                units,
                spreads if len(spreads) == len(units) else spreads * len(units),
                strict=True,
            )
        )

    @property
    def drives(self) -> tuple[str, ...]:
        """The parameters that scale the action of the inputs: one for each, or one for all."""
        return _each(self.drive)

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
            raise self._error(
                f"numba cannot compile it ({str(error).splitlines()[0]})",
                role,
                "Use numbers, arrays and functions of math only",
            ) from error

    def _error(self, problem: str, part: str, remedy: str) -> InputError:
        return InputError(
            problem, file=self.source or f"simulation {self.name}", field=part, remedy=remedy
        )


def _each(given: Any) -> tuple[Any, ...]:
    """Return what belongs to every input, whether to one or to several."""
    return given if isinstance(given, tuple) else (given,)
