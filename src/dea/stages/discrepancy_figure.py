"""Draw a diagnosis."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def discrepancy_figure(
    settings: Mapping[str, Any],
    localisation: Path,
    candidates: Path,
    certificate: Path,
    verdict: Path,
    png: Path,
    pdf: Path,
) -> None:
    """Draw where a simulation fails, what it lacks, and how sure that is."""
    import json

    from dea import store
    from dea.figures import style
    from dea.figures.discrepancy import discrepancy as draw

    figure = draw(
        store.read(localisation),
        store.read(candidates),
        store.read(certificate),
        json.loads(verdict.read_text()),
    )
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(
        discrepancy_figure,
        inputs=("localisation", "candidates", "certificate", "verdict"),
        outputs=("png", "pdf"),
    )
