"""Table 1: the terms of every actuator's model."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table1(
    settings: Mapping[str, Any],
    model: list[Path],
    validation: list[Path],
    csv: Path,
    md: Path,
    tex: Path,
) -> None:
    """Print it; a dataset's folder is the actuator's name."""
    from dea import store
    from dea.figures import tables

    table = tables.table1(
        {path.parent.name: store.read(path) for path in model},
        {path.parent.name: store.read(path) for path in validation},
    )
    tables.save(table, csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table1, inputs=("model*", "validation*"), outputs=("csv", "md", "tex"))
