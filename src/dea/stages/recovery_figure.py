"""How well known models come back, drawn."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def recovery_figure(settings: Mapping[str, Any], recovery: Path, png: Path, pdf: Path) -> None:
    """Draw ``recovery.nc``."""
    from dea import store
    from dea.figures import style
    from dea.figures.recovery import recovery as draw

    figure = draw(store.read(recovery))
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(recovery_figure, inputs=("recovery",), outputs=("png", "pdf"))
