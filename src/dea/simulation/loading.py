"""Find a simulation by name or in a user's Python file."""

import importlib.util
import re
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from dea.errors import InputError
from dea.provenance import note_read
from dea.simulation import devices
from dea.simulation.files_read import files_read
from dea.simulation.simulation import Simulation


def built_in() -> tuple[str, ...]:
    """Return the names of the simulations that come with the study: one module each."""
    return tuple(sorted(module.name for module in iter_modules(devices.__path__)))


def load_simulation(name: str | Path) -> Simulation:
    """Return a simulation of this package by name, or one from a user's Python file.

    Raises
    ------
    InputError
        If there is no such simulation, the file cannot be run, it lacks a ``simulation``, or the
        simulation has a missing port or an equation that does not give numbers.
    """
    if not isinstance(name, str | Path):
        raise InputError(
            f"it is a {type(name).__name__}",
            field="simulation",
            remedy="Give a Simulation, the name of one, or a Python file that defines `simulation`",
        )
    if str(name) in built_in():
        result: Simulation = import_module(f"{devices.__name__}.{name}").simulation
        return result
    path = Path(name)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(
            f"there is no {'file' if path.suffix == '.py' else 'simulation'} {str(name)!r}",
            field="simulation",
            remedy=f"Name one of {', '.join(built_in())}, "
            "or a Python file that defines `simulation`",
        )
    spec = importlib.util.spec_from_file_location(f"dea_user_simulation_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        with files_read() as read:
            # Functions that numba keeps compiled are found again by the module's name.
            sys.modules[spec.name] = module
            spec.loader.exec_module(module)
    except InputError as error:
        raise _explained(error, path) from error
    except (Exception, SystemExit) as error:  # whatever it raises is what is wrong with it
        raise InputError(
            f"it cannot be run ({type(error).__name__}: {error})",
            file=path,
            remedy="See docs/discrepancy.md for a worked example",
        ) from error
    note_read([path, *read])
    found = getattr(module, "simulation", None)
    if not isinstance(found, Simulation):
        raise InputError(
            "it defines no `simulation`",
            file=path,
            field="simulation",
            remedy="Assign a dea.simulation.Simulation to that name",
        )
    # What is compiled stays so; its file is how a saved extension finds it again.
    loaded = replace(found, derivative=found.compiled_derivative, output=found.compiled_output)
    object.__setattr__(loaded, "source", str(path))
    return loaded


def _explained(error: InputError, path: Path) -> InputError:
    """Return what is wrong in a file; where numba refused an equation, why and in which line."""
    problem, remedy = error.problem, error.remedy
    said = str(error.__cause__ or "")
    lines = [line for line in said.splitlines() if line.strip()]
    if type(error.__cause__).__module__.startswith("numba") and len(lines) > 1:
        reason = lines[1].partition(", defined at")[0].strip(" :")
        if unknown := re.search(r"name '(\w+)' is not defined", said):
            reason, remedy = f"{unknown[1]!r} is not defined", "Correct the name, or define it"
        place = re.search(r'^File ".*", line (\d+):', said, re.MULTILINE)
        line = f", line {place[1]}" if place else ""
        problem = f"numba cannot compile it{line}: {reason}"
    return InputError(problem, file=path, field=error.field, remedy=remedy)
