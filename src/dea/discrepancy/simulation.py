"""Physics simulations with ports where an effect can attach."""

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from dea.discrepancy.hold import HOLDS, Hold
from dea.discrepancy.integrate import DERIVATIVE, OUTPUT, compiled
from dea.discrepancy.parameter import Parameter
from dea.errors import InputError

BUILT_IN = ("dea_membrane", "cascaded_tanks", "mass_spring_damper", "electric_drive")


@dataclass(frozen=True)
class State:
    """A state: its value at the start, and how unsure that is (0: it settles in the lead-in)."""

    name: str
    unit: str
    initial: float
    spread: float = 0.0


@dataclass(frozen=True)
class Balance:
    """The port for forces: which state equation is a balance, and of what.

    Parameters
    ----------
    equation
        State whose derivative the force adds to.
    position
        State the force's elastic part looks at, or ``None`` where there is no such state.
    velocity
        State that is the rate of the motion; ``None`` takes the derivative of ``position``.
    rest
        Position at which the elastic force vanishes, in the unit of ``position``.
    reaction
        State equation that receives what the force takes from this one, where it acts between
        two parts of the device: two bodies, or two vessels. ``None`` where it acts from outside.
    """

    equation: str
    position: str | None
    velocity: str | None
    rest: float = 0.0
    reaction: str | None = None

    @property
    def name(self) -> str:
        """What the port is called among the others of its simulation."""
        return f"{self.equation}>{self.reaction}" if self.reaction else self.equation


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
        Name of the parameter that scales the action of the input: the port for its drift.
    balances
        The ports for forces: the equations that are balances, and what each balances with; none
        where no equation is.
    input_offset_spread
        Prior standard deviation of a constant about zero that adds to the input, in
        ``input_unit``: an amplifier's zero, or a constant load.
    output_gain_spread
        Prior standard deviation of the sensor's gain about one.
    output_offset_spread
        Prior standard deviation of the sensor's offset about zero, in ``output_unit``.
    accuracy
        Root mean square (in ``output_unit``) by which the simulation is known to miss the device
        through its own simplifications. What a diagnosis leaves over counts as explained down
        to there.
    lead_in
        Time (s) for which the first input is held before the record starts, so that the device
        has settled.
    hold
        How the input behaves between samples: ``zero`` holds it, as a converter does, ``linear``
        joins samples by straight lines, ``smooth`` suits a band-limited input that is measured.
    """

    name: str
    input_unit: str
    output_unit: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    derivative: Callable[..., Any]
    output: Callable[..., float]
    drive: str
    balances: tuple[Balance, ...]
    input_offset_spread: float = 0.0
    output_gain_spread: float = 0.0
    output_offset_spread: float = 0.0
    accuracy: float = 0.0
    lead_in: float = 0.0
    hold: Hold = "zero"
    source: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        names = [state.name for state in self.states] + [p.name for p in self.parameters]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise self._error(f"two things are called {doubled[0]!r}", "parameters", "Rename one")
        if self.drive not in self.parameter_names:
            raise self._error(
                f"the drive port names {self.drive!r}, which is no parameter",
                "drive",
                f"Name the parameter that scales the input: {', '.join(self.parameter_names)}",
            )
        if self.hold not in HOLDS:
            raise self._error(
                f"the input cannot behave as {self.hold!r} between samples",
                "hold",
                f"Choose from {', '.join(HOLDS)}",
            )
        for balance in self.balances:
            self._check_balance(balance)
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

    def _check_balance(self, balance: Balance) -> None:
        for role in ("equation", "position", "velocity", "reaction"):
            name = getattr(balance, role)
            if name not in self.state_names and not (name is None and role != "equation"):
                raise self._error(
                    f"a force-balance port names {name!r}, which is no state",
                    f"balances.{role}",
                    f"Name one of the states {', '.join(self.state_names)}",
                )
        if balance.position is None and balance.velocity is None:
            raise self._error(
                "a force-balance port has neither position nor velocity",
                "balances",
                "Name the state that moves",
            )

    def _check_indices(self, x: np.ndarray, p: np.ndarray) -> None:
        """Run both equations uncompiled once: a compiled one reads beyond its arrays unseen."""
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
                # Compiled, these are infinities, no numbers, or refused in words of their own.
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


def load_simulation(name: str | Path) -> Simulation:
    """Return a simulation of this package by name, or one from a user's Python file.

    Raises
    ------
    InputError
        If there is no such simulation, the file cannot be run, it lacks a ``simulation``, or the
        simulation has a missing port or an equation that does not give numbers.
    """
    if str(name) in BUILT_IN:
        return import_module(f"dea.discrepancy.simulations.{name}").simulation
    path = Path(name)
    if path.suffix != ".py" or not path.exists():
        raise InputError(
            f"there is no simulation {str(name)!r}",
            field="simulation",
            remedy=f"Name one of {', '.join(BUILT_IN)}, or a Python file that defines `simulation`",
        )
    spec = importlib.util.spec_from_file_location(f"dea_user_simulation_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except InputError as error:
        raise InputError(
            error.problem, file=path, field=error.field, remedy=error.remedy
        ) from error
    except Exception as error:  # whatever the user's file raises is what is wrong with it
        raise InputError(
            f"it cannot be run ({type(error).__name__}: {error})",
            file=path,
            remedy="See docs/discrepancy.md for a worked example",
        ) from error
    found = getattr(module, "simulation", None)
    if not isinstance(found, Simulation):
        raise InputError(
            "it defines no `simulation`",
            file=path,
            field="simulation",
            remedy="Assign a dea.discrepancy.Simulation to that name",
        )
    # Its file is how a saved extension finds it again; what is compiled stays so.
    return replace(
        found,
        source=str(path),
        derivative=found.compiled_derivative,
        output=found.compiled_output,
    )
