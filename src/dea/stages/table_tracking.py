"""Free-run simulation with fixed and with tracked parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_tracking(
    settings: Mapping[str, Any], track: list[Path], csv: Path, md: Path, tex: Path
) -> None:
    """Print it; a dataset's folder is the actuator's name."""
    from dea import store
    from dea.figures import tables

    table = tables.tracking({path.parent.name: store.read(path) for path in track})
    tables.save(table, csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_tracking, inputs=("track*",), outputs=("csv", "md", "tex"))
