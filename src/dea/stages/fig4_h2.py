"""Fig. 4: how two frequencies mix in every system."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def fig4_h2(settings: Mapping[str, Any], gfrf: list[Path], png: Path, pdf: Path) -> None:
    """Draw it; a dataset's folder is the system's name."""
    from dea import store
    from dea.figures import style
    from dea.figures.fig4_h2 import fig4_h2 as draw

    figure = draw({path.parent.name: store.read(path) for path in gfrf})
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(fig4_h2, inputs=("gfrf*",), outputs=("png", "pdf"))
