"""What was hidden against what was named: the confusion matrix of the blind trials."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trials_confusion(settings: Mapping[str, Any], scores: Path, png: Path, pdf: Path) -> None:
    """Draw it from a campaign's scores."""
    from dea import store
    from dea.figures import style
    from dea.figures.trials_confusion import trials_confusion as draw

    style.save(draw(store.read(scores)), (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(trials_confusion, inputs=("scores",), outputs=("png", "pdf"))
