"""How each hidden effect fared in the blind trials."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_trials_effects(
    settings: Mapping[str, Any], scores: Path, csv: Path, md: Path, tex: Path
) -> None:
    """Print it."""
    from dea import store
    from dea.figures import tables, trials_tables

    tables.save(trials_tables.effects(store.read(scores)), csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_trials_effects, inputs=("scores",), outputs=("csv", "md", "tex"))
