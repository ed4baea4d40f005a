"""The command line every stage shares: named input and output files, settings as JSON."""

import argparse
import atexit
import gc
import json
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from dea import provenance
from dea.errors import DeviceError, InputError, noted
from dea.progress import heard_by


def run(
    stage: Callable[..., None],
    *,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    numbers: Sequence[str] = (),
    named: Sequence[str] = (),
    mentioned: Sequence[str] = (),
    arguments: Sequence[str] | None = None,
) -> None:
    """Parse the command line and call ``stage(settings, **paths)``.

    Each name in ``inputs`` and ``outputs`` becomes an option ``--name PATH``; a name ending in
    ``*`` takes several paths. ``--settings`` is the JSON of the config leaves the stage needs. Each
    name in ``numbers`` becomes an option for a whole number that no result depends on. ``named``
    are dotted keys of the settings that name input files, ``mentioned`` options for files, or keys
    in them, that messages name and no result depends on. Within the workflow, inputs are compared
    with what their jobs made, and a description of the job is kept beside each product
    (:mod:`dea.provenance`).
    An :class:`~dea.errors.InputError` is printed without a traceback and exits with status 2; where
    it knows no file, since it comes from arrays, the stage's inputs are named. A
    :class:`~dea.errors.DeviceError` exits with status 1, as any other error does, with a traceback.
    """
    # Else the interpreter, as it ends, searches all that was imported for cycles to free, for up to
    # half a second.
    atexit.register(gc.freeze)
    # Else it searches hundreds of times while a stage imports, for a tenth of a second, among
    # objects that all stay.
    gc.set_threshold(10_000)
    parser = argparse.ArgumentParser(description=stage.__doc__)
    parser.add_argument("--settings", type=json.loads, default={}, metavar="JSON")
    for name in (*mentioned, *inputs, *outputs):
        option = "--" + name.rstrip("*").replace("_", "-")
        count = "*" if name.endswith("*") else None
        parser.add_argument(option, type=Path, required=True, metavar="PATH", nargs=count)
    for name in numbers:
        parser.add_argument("--" + name, type=int, required=True, metavar="N")
    values: dict[str, Any] = vars(parser.parse_args(arguments))
    settings = values.pop("settings")
    try:
        with (
            heard_by(_log_step),
            provenance.job(
                _command(stage, values, (*mentioned, *inputs, *outputs)),
                settings,
                inputs=[*_files(values, inputs), *_named(settings, named)],
                outputs=_files(values, outputs),
                free=[text for name in numbers for text in (f"--{name}", str(values[name]))],
            ),
        ):
            stage(settings, **values)
    except InputError as error:
        files = [] if error.file else _files(values, inputs)
        place = f"{', '.join(map(str, files))}: " if files else ""
        _say(f"error: {place}{noted(error)}\n")
        raise SystemExit(2) from None
    except DeviceError as error:
        _say(f"error: {noted(error)}\n")
        raise SystemExit(1) from None
    except Exception:
        _say(traceback.format_exc())
        raise SystemExit(1) from None


def _log_step(step: str) -> None:
    """Write a step to the log; the terminal shows the last one (``--logger progress``)."""
    # The job does not fail for a log on a full disk; it fails when it writes its products.
    with suppress(OSError):
        sys.stderr.write(f"step: {step}\n")
        sys.stderr.flush()


def _say(text: str) -> None:
    """Print to the log, which standard error is, or to the terminal where the log takes no more."""
    try:
        sys.stderr.write(text)
        sys.stderr.flush()
    except OSError:
        sys.stdout.write(text)
        # Else the interpreter tries the log again when it ends.
        sys.stderr = None


def _command(
    stage: Callable[..., None], values: Mapping[str, Any], names: Iterable[str]
) -> list[str]:
    """Return the stage's module and its options for files, which no number of cores changes."""
    spec = sys.modules[stage.__module__].__spec__
    command = [spec.name if spec else stage.__module__]
    for name in names:
        option = "--" + name.rstrip("*").replace("_", "-")
        command += [option, *map(str, _files(values, [name]))]
    return command


def _files(values: Mapping[str, Any], names: Iterable[str]) -> list[Path]:
    """Return the files that these options name, those of several in turn."""
    found = [values[name.rstrip("*")] for name in names]
    return [file for one in found for file in (one if isinstance(one, list) else [one])]


def _named(settings: Mapping[str, Any], keys: Iterable[str]) -> list[Path]:
    """Return the files that these dotted keys of the settings name.

    A key may be missing, or name something of the library's own, which has no suffix.
    """
    files = []
    for key in keys:
        value: Any = settings
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        if isinstance(value, str) and Path(value).suffix:
            files.append(Path(value))
    return files
