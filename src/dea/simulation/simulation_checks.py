"""What makes a simulation one that can be run."""

import inspect
from collections.abc import Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from dea.effect_label import RESERVED
from dea.simulation.equations import beyond, raising, returning
from dea.simulation.force_port import ForcePort
from dea.simulation.inputs import each_of
from dea.simulation.interpolation import INTERPOLATIONS
from dea.simulation.parameter import GIVEN

if TYPE_CHECKING:
    from dea.simulation.simulation import Simulation


def check(simulation: "Simulation") -> None:
    """Check that the parts of a simulation fit each other and its equations.

    Raises
    ------
    InputError
        Naming the first part that does not.
    """
    _check_names(simulation)
    _check_inputs(simulation)
    _check_numbers(simulation)
    known = ", ".join(simulation.parameter_names)
    for drive in simulation.drives:
        if drive not in simulation.parameter_names:
            raise simulation.error(
                f"the drive names {drive!r}, which is no parameter",
                "drive",
                f"Name the parameter that scales the input: {known}",
            )
    if simulation.input_interpolation not in INTERPOLATIONS:
        raise simulation.error(
            f"there is no input interpolation {simulation.input_interpolation!r}",
            "input_interpolation",
            f"Choose from {', '.join(INTERPOLATIONS)}",
        )
    through = simulation.sensor_filter
    if through and not (0.0 < through.cutoff < np.inf and through.order >= 1):
        raise simulation.error(
            f"there is no low-pass of order {through.order} and {through.cutoff} Hz",
            "sensor_filter",
            "Give a finite cutoff above 0 Hz and an order of at least 1, or leave it out",
        )
    for port in simulation.force_ports:
        _check_force_port(simulation, port)
    dx = np.full(len(simulation.states), np.nan)
    x = np.array([state.initial for state in simulation.states])
    p = simulation.nominal
    _check_indices(simulation, x, p)
    simulation.compiled_derivative(x, simulation.no_input, p, dx)
    y = simulation.compiled_output(x, simulation.no_input, p)
    if not (np.isfinite(dx).all() and np.isfinite(y)):
        bad = [
            s.name for s, value in zip(simulation.states, dx, strict=True) if not np.isfinite(value)
        ]
        raise simulation.error(
            f"at the nominal parameters and no input the {'derivative' if bad else 'output'} "
            f"{'of ' + ', '.join(bad) + ' ' if bad else ''}is not a number",
            "derivative" if bad else "output",
            "Check its equations and the nominal values",
        )


def _check_names(simulation: "Simulation") -> None:
    """Check that names are unique, and that none is one that the library gives."""
    states, parameters = simulation.state_names, simulation.parameter_names
    ports = tuple(port.name for port in simulation.force_ports)
    told_apart = "Leave one out: ports are told apart by the equations that they act on"
    for what, field, names, remedy in (
        ("states or parameters", "parameters", (*states, *parameters), "Rename one"),
        ("force ports", "force_ports", ports, told_apart),
    ):
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise simulation.error(f"two {what} are called {doubled[0]!r}", field, remedy)
    for name in parameters:
        if name in GIVEN or "." in name:
            raise simulation.error(
                f"{name!r} is a name that the library gives",
                f"parameters.{name}",
                f"Choose one without a point, and none of {', '.join(GIVEN)}",
            )
    _check_separators(simulation, "states", states)
    _check_separators(simulation, "input_name", each_of(simulation.input_name))


def _check_separators(simulation: "Simulation", field: str, names: Sequence[str]) -> None:
    for name in names:
        if any(character in name for character in RESERVED):
            raise simulation.error(
                f"the name {name!r} holds one of {' '.join(RESERVED)}",
                field,
                "Leave these out: they separate effects and their places",
            )


def _check_inputs(simulation: "Simulation") -> None:
    """Check that every input has what belongs to it."""
    several = isinstance(simulation.input_unit, tuple)
    count = len(each_of(simulation.input_unit))
    for role, shared in (
        ("input_unit", False),
        ("input_name", False),
        ("drive", True),
        ("input_offset_spread", True),
    ):
        given = getattr(simulation, role)
        fits = isinstance(given, tuple) is several or (several and shared)
        if not fits or (isinstance(given, tuple) and len(given) != max(count, 2)):
            raise simulation.error(
                f"it holds {len(each_of(given))} for {count} input{'s' * (count > 1)}",
                role,
                "Give a tuple with one for each of several inputs; of one input no tuple",
            )
    for role, names in (
        ("input_name", each_of(simulation.input_name)),
        ("drive", simulation.drives),
    ):
        if len(set(names)) < len(names):
            raise simulation.error(
                f"two inputs have {max(names, key=names.count)!r}",
                role,
                "Give each its own" + ", or name one drive for all" * (role == "drive"),
            )
    if several and simulation.action is not None:
        raise simulation.error(
            "an action supports one input only, and there are several",
            "action",
            "Leave it out",
        )


def _check_numbers(simulation: "Simulation") -> None:
    """Check that deviations, errors and times are finite and not negative, and bounds hold."""

    def possible(value: Any) -> bool:
        return isinstance(value, Real) and 0.0 <= float(value) < np.inf

    spreads = ("input_offset_spread", "output_gain_spread", "output_offset_spread")
    for role in (*spreads, "accuracy", "lead_in"):
        for value in each_of(getattr(simulation, role)):
            if not possible(value):
                raise simulation.error(
                    f"it is {value!r}", role, "Give a finite number that is not negative"
                )
    for state in simulation.states:
        if not possible(state.spread):
            raise simulation.error(
                f"it is {state.spread!r}",
                f"states.{state.name}.spread",
                "Give a finite deviation that is not negative",
            )
    for own in simulation.parameters:
        if not own.low <= own.nominal <= own.high:
            raise simulation.error(
                f"it is {own.nominal:g}, and its bounds are {own.low:g} and {own.high:g}",
                f"parameters.{own.name}.nominal",
                "Give a value within its bounds",
            )


def _check_force_port(simulation: "Simulation", port: ForcePort) -> None:
    for role in ("equation", "position", "velocity", "reaction"):
        name = getattr(port, role)
        if name not in simulation.state_names and not (name is None and role != "equation"):
            raise simulation.error(
                f"a force port names {name!r}, which is no state",
                f"force_ports.{role}",
                f"Name one of the states {', '.join(simulation.state_names)}",
            )
    if port.divisor is not None and port.divisor not in simulation.parameter_names:
        raise simulation.error(
            f"a force port names {port.divisor!r}, which is no parameter",
            "force_ports.divisor",
            f"Name one of the parameters {', '.join(simulation.parameter_names)}",
        )
    if port.divisor is not None and port.reaction is not None:
        raise simulation.error(
            "a force port has a divisor and a reaction, whose equation may have another one",
            "force_ports",
            "Leave one of them out",
        )
    if port.position is None and port.velocity is None:
        raise simulation.error(
            "a force port has neither position nor velocity",
            "force_ports",
            "Name the state that moves",
        )


def _check_indices(simulation: "Simulation", x: np.ndarray, p: np.ndarray) -> None:
    """Read both equations, and run them uncompiled once: compiled ones check no indices."""
    several = f" of {len(simulation.inputs)} inputs" * (len(simulation.inputs) > 1)
    states = "is 1 state" if x.size == 1 else f"are {x.size} states"
    parameters = "1 parameter" if p.size == 1 else f"{p.size} parameters"
    remedy = f"There {states} and {parameters}{several}, counted from 0"
    for function, role, own in (
        (simulation.derivative, "derivative", (np.empty_like(x),)),
        (simulation.output, "output", ()),
    ):
        _check_arguments(simulation, function, role, ("x", "u", "p", "dx")[: 3 + len(own)])
        undeclared = beyond(function, (x.size, len(simulation.inputs), p.size, x.size))
        if undeclared:
            raise simulation.error(
                f"it uses a state or parameter that is not declared ({undeclared})",
                role,
                remedy,
            )
        returned = returning(function) if own else None
        if returned:
            raise simulation.error(
                f"it returns a value ({returned})",
                role,
                f"Write the rates into its last argument: dx[0] to dx[{x.size - 1}]",
            )
        exception = raising(function)
        if exception:
            raise simulation.error(
                f"it raises an exception ({exception}), which compiled code cannot",
                role,
                "Give a value that is not a number instead: such a run counts as unstable",
            )
        try:
            with np.errstate(all="ignore"):
                plain = getattr(function, "py_func", function)
                plain(x.copy(), simulation.no_input, p.copy(), *own)
        except IndexError as error:
            raise simulation.error(
                f"it uses a state or parameter that is not declared ({error})", role, remedy
            ) from error
        except (ArithmeticError, ValueError, NameError, TypeError):
            # Compiled, these give infinities or NaN, or the compiler refuses them.
            continue


def _check_arguments(
    simulation: "Simulation", function: Any, role: str, names: tuple[str, ...]
) -> None:
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
    raise simulation.error(problem, role, f"Give a function {role}({', '.join(names)})")
