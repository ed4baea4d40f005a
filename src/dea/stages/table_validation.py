"""Scores of every actuator, window, model and approach."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_validation(
    settings: Mapping[str, Any], validation: list[Path], csv: Path, md: Path, tex: Path
) -> None:
    """Print it; a dataset's folder is the actuator's name."""
    from dea import store
    from dea.figures import tables

    table = tables.validation({path.parent.name: store.read(path) for path in validation})
    tables.save(table, csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_validation, inputs=("validation*",), outputs=("csv", "md", "tex"))
