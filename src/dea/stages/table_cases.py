"""Free-run errors on the test records of every case, beside published ones."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_cases(
    settings: Mapping[str, Any],
    scores: list[Path],
    published: Path,
    csv: Path,
    md: Path,
    tex: Path,
) -> None:
    """Print it; a dataset's folder is the case's name."""
    import yaml

    from dea import store
    from dea.figures import cases_table, tables

    errors = yaml.safe_load(published.read_text())["errors"]
    table = cases_table.cases({path.parent.name: store.read(path) for path in scores}, errors)
    tables.save(table, csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_cases, inputs=("scores*", "published"), outputs=("csv", "md", "tex"))
