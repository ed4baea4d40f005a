"""Fig. 2: orders and validation of one system."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def fig2(settings: Mapping[str, Any], orders: Path, validation: Path, png: Path, pdf: Path) -> None:
    """Draw it from the system's own datasets."""
    from dea import store
    from dea.figures import style
    from dea.figures.fig2 import fig2 as draw

    figure = draw(store.read(orders), store.read(validation), settings["system"])
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(fig2, inputs=("orders", "validation"), outputs=("png", "pdf"))
