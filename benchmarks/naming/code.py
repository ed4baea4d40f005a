"""Which code made a file, so that what other code made is made again."""

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[2]
_SOURCES = {"dea": ROOT / "src", "benchmarks": ROOT}


def digest(patterns: Iterable[str], files: Iterable[Path] = ()) -> str:
    """Return a digest of the project's files that match patterns, and of other files."""
    matching = {file for pattern in patterns for file in ROOT.glob(pattern)}
    found = sorted(hashlib.sha256(file.read_bytes()).digest() for file in matching | set(files))
    return hashlib.sha256(b"".join(found)).hexdigest()


@cache
def imported(*names: str) -> frozenset[Path]:
    """Return the files of modules and of all that they import, directly or not.

    Importing a module runs the packages above it, so these and their imports count too. Modules
    that are found by name at run time are not seen.
    """
    graph = import_graph()
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name and name not in found:
            found.add(name)
            pending.extend(graph.find_modules_directly_imported_by(name))
            pending.append(name.rpartition(".")[0])
    return frozenset(map(_file, found))


@cache
def import_graph() -> grimp.ImportGraph:
    """Return which module imports which.

    It is read by threads that a forked process does not have: one that would call this for the
    first time waits for ever where its parent has read any such graph before.
    """
    return grimp.build_graph(*_SOURCES, exclude_type_checking_imports=True, cache_dir=None)


def _file(module: str) -> Path:
    path = _SOURCES[module.partition(".")[0]].joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
