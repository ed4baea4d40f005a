"""The command line every stage shares: named input and output files, settings as JSON."""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from dea.errors import DeviceError, InputError


def run(
    stage: Callable[..., None],
    *,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    numbers: Sequence[str] = (),
    arguments: Sequence[str] | None = None,
) -> None:
    """Parse the command line and call ``stage(settings, **paths)``.

    Each name in ``inputs`` and ``outputs`` becomes an option ``--name PATH``; a name ending in
    ``*`` takes several paths. ``--settings`` is the JSON of the config leaves the stage needs. Each
    name in ``numbers`` becomes an option for a whole number that no result depends on.
    An :class:`~dea.errors.InputError` is printed without a traceback and exits with status 2; where
    it knows no file, since it comes from arrays, the stage's inputs are named. A
    :class:`~dea.errors.DeviceError` exits with status 1.
    """
    parser = argparse.ArgumentParser(description=stage.__doc__)
    parser.add_argument("--settings", type=json.loads, default={}, metavar="JSON")
    for name in (*inputs, *outputs):
        option = "--" + name.rstrip("*").replace("_", "-")
        count = "*" if name.endswith("*") else None
        parser.add_argument(option, type=Path, required=True, metavar="PATH", nargs=count)
    for name in numbers:
        parser.add_argument("--" + name, type=int, required=True, metavar="N")
    values: dict[str, Any] = vars(parser.parse_args(arguments))
    try:
        stage(values.pop("settings"), **values)
    except InputError as error:
        place = "" if error.file else _joined(values[name.rstrip("*")] for name in inputs)
        print(f"error: {place}{error}", file=sys.stderr)
        raise SystemExit(2) from None
    except DeviceError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(1) from None


def _joined(inputs: Iterable[Path | list[Path]]) -> str:
    files = [file for one in inputs for file in (one if isinstance(one, list) else [one])]
    return f"{', '.join(map(str, files))}: " if files else ""
