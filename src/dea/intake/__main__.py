"""Write the case of a file and print its name: ``python -m dea.intake mine.csv``.

Without a file, check the name of a case.
"""

import argparse
import sys
from collections.abc import Sequence
from math import inf, nan
from pathlib import Path

from dea.errors import InputError
from dea.intake.case import infer_case
from dea.intake.case_file import case_name, known_name, write_case
from dea.intake.questions import command
from dea.intake.roles import Answers

_CASES = Path("config/cases")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line. The name goes to stdout, what was inferred to stderr."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, nargs="?")
    parser.add_argument("--input", metavar="COLUMN:UNITS[,COLUMN:UNITS]")
    parser.add_argument("--output", metavar="COLUMN:UNITS")
    parser.add_argument("--time", metavar="COLUMN:UNITS")
    parser.add_argument("--rate", metavar="HZ")
    parser.add_argument("--name")
    parser.add_argument("--simulation", metavar="FILE.py")
    parser.add_argument("--goal", default="case", help="target of make, for questions")
    options = parser.parse_args(arguments)
    given = {
        key.upper(): str(value)
        for key in ("file", "input", "output", "time", "rate", "name", "simulation")
        if (value := getattr(options, key)) is not None
    }
    try:
        if options.file is None:
            known = known_name(options.name or "", _CASES, actuators=options.goal == "diagnose")
            print(known)
            return 0
        rate = _rate(options.rate)
        inferred = infer_case(
            options.file,
            Answers(options.input, options.output, options.time, rate),
            simulation=options.simulation,
            goal=options.goal,
            given=given,
        )
        name = case_name(options.file, options.name)
        written = write_case(inferred, name, _CASES, command(options.goal, given))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{written}, inferred from {options.file}:", file=sys.stderr)
    for line in inferred.inferred:
        print(f"  {line}", file=sys.stderr)
    print(name)
    return 0


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
