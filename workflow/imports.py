"""Which files of ``src/dea`` a stage depends on, from the package's import graph.

A list of them, with their hashes, as an input of a rule makes an edited module rerun what depends
on it and nothing else.
"""

import hashlib
from functools import cache
from pathlib import Path

import grimp

from dea import provenance
from dea.atomic_file import atomic

SOURCE = Path("src")
PACKAGE = "dea"
ENVIRONMENT = Path("build/environment.txt")
LISTS = Path("build/code")


def modules(*names: str) -> list[str]:
    """Return the files of the modules ``names`` and of all they import, directly or not.

    Imports inside functions count; those that only the type checker reads do not. Importing a
    module runs the packages above it, so these and their imports count too.
    """
    graph = _graph()
    known = graph.modules
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name not in found and name in known:
            found.add(name)
            pending.extend(graph.find_modules_directly_imported_by(name))
            pending.append(name.rpartition(".")[0])
        elif name and name not in known:
            raise ValueError(f"{SOURCE} has no module {name}")
    return sorted(map(_file, found))


@cache
def _graph() -> grimp.ImportGraph:
    # Takes a tenth of a second: a cache, which two processes could write to at once, saves nothing.
    return grimp.build_graph(PACKAGE, exclude_type_checking_imports=True, cache_dir=None)


@cache
def environment() -> str:
    """Return the file that lists the installed packages, brought up to date."""
    return _kept(ENVIRONMENT, "\n".join([*provenance.packages(), ""]))


def listed(files: list[str]) -> str:
    """Return the file that lists ``files`` with their SHA-256, as ``sha256sum`` does.

    One input for a job instead of a hundred, since hundreds of actuators have thousands of jobs.
    Its name tells what it says: a list that an edit changed under a job that runs, or whose date is
    not newer than a result, would not be seen.
    """
    names = sorted(set(files))
    text = "".join(f"{content(name)}  {name}\n" for name in names)
    return _kept(LISTS / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.txt", text)


@cache
def content(name: str) -> str:
    """Return the SHA-256 of a file, nothing where there is none.

    As a parameter of a job it tells a file that was replaced by one of an earlier date: Snakemake
    compares the contents of inputs that are newer than a result alone.
    """
    return provenance.digest(Path(name)) if Path(name).exists() else ""


def _kept(file: Path, text: str) -> str:
    """Write a file where it says something else, whole or not at all; return its name."""
    if not file.exists() or file.read_text() != text:
        with atomic(file) as partial:
            partial.write_text(text)
    return str(file)


def _file(module: str) -> str:
    path = SOURCE.joinpath(*module.split("."))
    return str(path / "__init__.py" if path.is_dir() else path.with_suffix(".py"))
