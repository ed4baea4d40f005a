"""What verdicts are worth, by the strength of the hidden effect and by the excitation."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trials_strength(settings: Mapping[str, Any], scores: Path, png: Path, pdf: Path) -> None:
    """Draw it from a campaign's scores."""
    from dea import store
    from dea.figures import style
    from dea.figures.trials_strength import trials_strength as draw

    style.save(draw(store.read(scores)), (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(trials_strength, inputs=("scores",), outputs=("png", "pdf"))
