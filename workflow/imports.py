"""Which files of ``src/dea`` a stage depends on, from the package's import graph.

Listing them as inputs of a rule makes an edited module rerun what depends on it and nothing else.
"""

from functools import cache
from pathlib import Path

import grimp

from dea import provenance

SOURCE = Path("src")
PACKAGE = "dea"
ENVIRONMENT = Path("build/environment.txt")


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
    text = "\n".join([*provenance.packages(), ""])
    if not ENVIRONMENT.exists() or ENVIRONMENT.read_text() != text:
        ENVIRONMENT.parent.mkdir(exist_ok=True)
        ENVIRONMENT.write_text(text)
    return str(ENVIRONMENT)


def _file(module: str) -> str:
    path = SOURCE.joinpath(*module.split("."))
    return str(path / "__init__.py" if path.is_dir() else path.with_suffix(".py"))
