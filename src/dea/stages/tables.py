"""Make tables that share their files."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def tables(
    settings: Mapping[str, Any],
    sources: list[Path],
    csv: list[Path],
    md: list[Path],
    tex: list[Path],
) -> None:
    """Write each table of ``settings["tables"]`` at the paths of its place.

    A table is the function ``tabulate`` of the module of its name in :mod:`dea.tables`.
    """
    from importlib import import_module

    from dea import store
    from dea.tables.table import Table, save

    found = store.Sources(sources)
    for name, *paths in zip(settings["tables"], csv, md, tex, strict=True):
        tabulate: Callable[[store.Sources], Table] = import_module(f"dea.tables.{name}").tabulate
        save(tabulate(found), *paths)


if __name__ == "__main__":
    run(tables, inputs=("sources*",), outputs=("csv*", "md*", "tex*"))
