"""How often blind trials were named rightly."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_trials(settings: Mapping[str, Any], scores: Path, csv: Path, md: Path, tex: Path) -> None:
    """Print it."""
    from dea import store
    from dea.figures import tables, trials_tables

    tables.save(trials_tables.rates(store.read(scores)), csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_trials, inputs=("scores",), outputs=("csv", "md", "tex"))
