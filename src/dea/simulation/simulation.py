"""A physics simulation of a device."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from dea.errors import InputError
from dea.simulation.force_port import ForcePort
from dea.simulation.input_action import InputAction
from dea.simulation.interpolation import INTERPOLATIONS, InputInterpolation
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT, compiled
from dea.simulation.state import State


@dataclass(frozen=True)
class Simulation:
    """What is known about a device, and where something could be missing.

    Parameters
    ----------
    derivative
        ``derivative(x, u, p, dx)`` writes dx/dt for the states ``x``, the input ``u`` and the
        parameters ``p``, in the order of ``states`` and ``parameters``. Numba compiles it.
    output
        ``output(x, u, p)`` returns the simulated output.
    drive
        Name of the parameter that scales the action of the input; effects in time scale it.
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
        not in every evaluation of the derivative; none where that would save nothing.
    """

    name: str
    input_unit: str
    output_unit: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    derivative: Callable[..., Any]
    output: Callable[..., float]
    drive: str
    force_ports: tuple[ForcePort, ...]
    input_offset_spread: float = 0.0
    output_gain_spread: float = 0.0
    output_offset_spread: float = 0.0
    accuracy: float = 0.0
    lead_in: float = 0.0
    input_interpolation: InputInterpolation = "zero"
    action: InputAction | None = None
    source: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        names = [state.name for state in self.states] + [p.name for p in self.parameters]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise self._error(
                f"two states or parameters are called {doubled[0]!r}", "parameters", "Rename one"
            )
        if self.drive not in self.parameter_names:
            raise self._error(
                f"the drive names {self.drive!r}, which is no parameter",
                "drive",
                f"Name the parameter that scales the input: {', '.join(self.parameter_names)}",
            )
        if self.input_interpolation not in INTERPOLATIONS:
            raise self._error(
                f"there is no input interpolation {self.input_interpolation!r}",
                "input_interpolation",
                f"Choose from {', '.join(INTERPOLATIONS)}",
            )
        for port in self.force_ports:
            self._check_force_port(port)
        dx = np.full(len(self.states), np.nan)
        x = np.array([state.initial for state in self.states])
        p = self.nominal
        self._check_indices(x, p)
        self.compiled_derivative(x, 0.0, p, dx)
        y = self.compiled_output(x, 0.0, p)
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

    def _check_force_port(self, port: ForcePort) -> None:
        for role in ("equation", "position", "velocity", "reaction"):
            name = getattr(port, role)
            if name not in self.state_names and not (name is None and role != "equation"):
                raise self._error(
                    f"a force port names {name!r}, which is no state",
                    f"force_ports.{role}",
                    f"Name one of the states {', '.join(self.state_names)}",
                )
        if port.position is None and port.velocity is None:
            raise self._error(
                "a force port has neither position nor velocity",
                "force_ports",
                "Name the state that moves",
            )

    def _check_indices(self, x: np.ndarray, p: np.ndarray) -> None:
        """Run both equations uncompiled once, since compiled ones do not check indices."""
        for function, role, own in (
            (self.derivative, "derivative", (np.empty_like(x),)),
            (self.output, "output", ()),
        ):
            try:
                with np.errstate(all="ignore"):
                    plain = getattr(function, "py_func", function)
                    plain(x.copy(), np.float64(0.0), p.copy(), *own)
            except IndexError as error:
                raise self._error(
                    f"it uses a state or parameter that is not declared ({error})",
                    role,
                    f"There are {x.size} states and {p.size} parameters, counted from 0",
                ) from error
            except (ArithmeticError, ValueError, NameError, TypeError):
                # Compiled, these give infinities or NaN, or the compiler refuses them.
                continue

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
        return self._compile(self.derivative, DERIVATIVE, "derivative")

    @cached_property
    def compiled_output(self) -> Any:
        """The output as a compiled function of the integrator's signature."""
        return self._compile(self.output, OUTPUT, "output")

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
