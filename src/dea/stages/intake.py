"""Write the case of a file and print its name: ``python -m dea.stages.intake mine.csv``.

Without a file, check the case that is named. A simulation is loaded before anything is written.
What a case of the file already says of its columns stands, unless an option says otherwise.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

from dea import store
from dea.configuration.case import simulation_of
from dea.configuration.study import RESERVED, settings
from dea.errors import InputError
from dea.intake import (
    Answers,
    case_name,
    command,
    earlier_case,
    infer_case,
    known_name,
    read_case,
    write_case,
)

_CASES = Path("config/cases")
_DIAGNOSED = ("diagnose", "resolve")  # targets that need the simulation of a case


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line. The name goes to stdout, what was inferred to stderr."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, nargs="?")
    parser.add_argument("--input", metavar="COLUMN:UNITS[,COLUMN:UNITS]")
    parser.add_argument("--output", metavar="COLUMN:UNITS")
    parser.add_argument("--time", metavar="COLUMN:UNITS")
    parser.add_argument("--rate", metavar="HZ")
    parser.add_argument("--sheet")
    parser.add_argument("--name")
    parser.add_argument("--simulation", metavar="FILE.py")
    parser.add_argument("--goal", default="case", help="target of make, for questions")
    parser.add_argument("--result", type=Path, help="check whose result this is, and no more")
    options = parser.parse_args(arguments)
    given = {
        key.upper(): str(value)
        for key in ("file", "input", "output", "time", "rate", "sheet", "name", "simulation")
        if (value := getattr(options, key)) is not None
    }
    try:
        if options.result is not None:
            _check_whose(options.result)
            return 0
        if options.file is None:
            _check_named(options.name or "", options.goal)
            print(options.name)
            return 0
        name = case_name(options.file, options.name, options.sheet)
        answers = Answers(
            input=options.input,
            output=options.output,
            time=options.time,
            rate=_rate(options.rate),
            sheet=options.sheet,
        )
        file = _CASES / f"{name}.yaml"
        earlier = earlier_case(options.file, options.sheet, file)
        kept = earlier.simulation if earlier and options.simulation is None else None
        simulation = options.simulation or kept
        inferred = infer_case(
            options.file, answers, simulation=simulation, goal=options.goal, given=given,
            kept=earlier.record if earlier else None,
        )  # fmt: skip
        if simulation is not None:
            named = (file, "simulation") if kept else (None, "SIMULATION")
            _check_simulation(simulation, inferred.content["record"], *named)
        if kept is not None:
            said = f"the simulation of this case, {kept}, is kept"
            inferred = replace(inferred, inferred=(*inferred.inferred, said))
        written = write_case(inferred, name, _CASES, command(options.goal, given))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{written}, inferred from {options.file}:", file=sys.stderr)
    for line in inferred.inferred:
        print(f"  {line}", file=sys.stderr)
    print(name)
    return 0


def _check_named(name: str, goal: str) -> None:
    """Check an actuator or a case, and its simulation where it is to be diagnosed.

    Raises
    ------
    InputError
        With the names that are known, or what is wrong with the case.
    """
    known_name(name, _CASES, actuators=goal != "case")
    file = _CASES / f"{name}.yaml"
    if not file.exists():
        return
    case = read_case(file)
    if goal in _DIAGNOSED or case.simulation is not None:
        _check_simulation(simulation_of(case, file), settings(case.record), file, "simulation")


def _check_whose(result: Path) -> None:
    """Check the actuator or case of ``results/NAME/…`` or ``results/discrepancy/NAME/…``.

    Raises
    ------
    InputError
        With the names that are known.
    """
    _, *folders, _ = result.parts
    if folders[:1] in (["discrepancy"], ["resolve"]):
        del folders[0]
    if folders and folders[0] not in RESERVED:
        known_name(folders[0], _CASES, actuators=True, field=str(result))


def _check_simulation(name: str, record: Mapping[str, Any], file: Path | None, field: str) -> None:
    """Load a simulation, and compare its inputs and units with the columns of a record.

    Raises
    ------
    InputError
        If there is none, its file is wrong, or it is of other signals.
    """
    from dea.discrepancy import signals_of
    from dea.simulation import load_simulation

    try:
        # What it prints is no name of a case.
        with redirect_stdout(sys.stderr):
            own = load_simulation(name)
    except InputError as error:
        if error.file is not None:
            raise
        delete = f", or delete {file}" if file else ""
        raise error.at(file=file, field=field, remedy=f"{error.remedy}{delete}") from error
    try:
        signals_of(store.import_record(record, file), own)
    except InputError as error:
        raise error.at(file=error.file or file or name) from error


def _rate(text: str | None) -> float | None:
    """Return the samples per second that were given, if any.

    Raises
    ------
    InputError
        If it is no number above 0.
    """
    if text is None:
        return None
    try:
        rate = float(text)
    except ValueError:
        rate = nan
    if not 0 < rate < inf:
        remedy = "Give samples per second, a number above 0 without units"
        raise InputError(f"it is {text!r}", field="RATE", remedy=remedy)
    return rate


if __name__ == "__main__":
    sys.exit(main())
