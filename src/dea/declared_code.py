"""Within a job of the workflow: refuse code of this package that the job's rule does not declare.

A rule lists the files that its job depends on, so that the job runs again when one is edited. The
list comes from import statements; what else a job loads (a module found by its name or file, a
data file) would be missed, and its edits would leave stale results.
"""

import os
import sys
from importlib.util import source_from_cache
from pathlib import Path
from typing import Any

VARIABLE = "DEA_CODE"
_PACKAGE = Path(__file__).resolve().parent


def refuse_undeclared_code() -> None:
    """Exit when this process loads a module or opens a data file that DEA_CODE does not list.

    DEA_CODE holds the names of files, separated by blanks; where it is not set, there is no job
    and nothing is refused. Processes that the job starts inherit it. Only files that are opened
    by Python are seen, not those that a C library opens.
    """
    if VARIABLE not in os.environ:
        return
    declared = frozenset(Path(name).resolve() for name in os.environ[VARIABLE].split())
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == _PACKAGE.name and module.__file__:
            _check(module.__file__, declared)

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        # A file descriptor is a number: its file was seen by name when it was opened.
        if event == "open" and not isinstance(arguments[0], int):
            _check(os.fsdecode(arguments[0]), declared)

    sys.addaudithook(watch)


def _check(file: str, declared: frozenset[Path]) -> None:
    source = _source(file)
    if source is None or not source.is_relative_to(_PACKAGE) or source in declared:
        return
    name = os.path.relpath(source)
    module = ".".join((_PACKAGE.name, *source.relative_to(_PACKAGE).with_suffix("").parts))
    remedy = f"modules('{module}')" if source.suffix == ".py" else f"'{name}'"
    # Not an exception of the kinds that stages and libraries catch.
    raise SystemExit(
        f"error: {name}: {_program()} loads it, but its rule does not declare it. "
        f"Add {remedy} to the inputs `code` of the rule."
    )


def _source(file: str) -> Path | None:
    """Return the source of compiled bytecode; None for what else is in such a cache."""
    opened = Path(os.path.abspath(file))
    elsewhere = sys.pycache_prefix and opened.is_relative_to(os.path.abspath(sys.pycache_prefix))
    if elsewhere or opened.parent.name == "__pycache__":
        # While it is written, bytecode has a number after its suffix.
        name, suffix, _ = opened.name.partition(".pyc")
        if not suffix:
            return None
        return Path(os.path.realpath(source_from_cache(str(opened.with_name(name + suffix)))))
    return None if "__pycache__" in opened.parts else Path(os.path.realpath(opened))


def _program() -> str:
    """Return the module that ``python -m`` runs, else the name of the program."""
    command = sys.orig_argv
    return command[command.index("-m") + 1] if "-m" in command else sys.argv[0]
