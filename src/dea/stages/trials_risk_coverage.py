"""How many names are wrong, against how many trials are given one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trials_risk_coverage(settings: Mapping[str, Any], scores: Path, png: Path, pdf: Path) -> None:
    """Draw it from a campaign's scores."""
    from dea import store
    from dea.figures import style
    from dea.figures.trials_risk_coverage import trials_risk_coverage as draw

    style.save(draw(store.read(scores)), (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(trials_risk_coverage, inputs=("scores",), outputs=("png", "pdf"))
