"""What the diagnosed cases lack, and what naming it is worth on records not used for it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def table_real_records(
    settings: Mapping[str, Any],
    verdicts: list[Path],
    published: Path,
    csv: Path,
    md: Path,
    tex: Path,
) -> None:
    """Print it; a verdict's folder is the case's name."""
    import json

    import yaml

    from dea.figures import tables
    from dea.figures.real_records_table import real_records

    goals = yaml.safe_load(published.read_text())["extensions"]
    found = {path.parent.name: json.loads(path.read_text()) for path in verdicts}
    tables.save(real_records(found, goals), csv=csv, md=md, tex=tex)


if __name__ == "__main__":
    run(table_real_records, inputs=("verdicts*", "published"), outputs=("csv", "md", "tex"))
