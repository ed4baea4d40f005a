"""How the published plants came back from their simulated records."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_recovery(
    settings: Mapping[str, Any], recovery: Path, csv: Path, md: Path, tex: Path
) -> None:
    """Print it."""
    from dea import store
    from dea.figures import tables

    tables.save(tables.recovery(store.read(recovery)), csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_recovery, inputs=("recovery",), outputs=("csv", "md", "tex"))
