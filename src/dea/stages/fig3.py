"""Fig. 3: gain or phase of H1 over time of every system."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def fig3(
    settings: Mapping[str, Any], record: list[Path], gfrf: list[Path], png: Path, pdf: Path
) -> None:
    """Draw it; a dataset's folder is the system's name."""
    from dea import store
    from dea.figures import style
    from dea.figures.fig3 import fig3 as draw

    figure = draw(
        {path.parent.name: store.read_record(path) for path in record},
        {path.parent.name: store.read(path) for path in gfrf},
        settings["quantity"],
    )
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(fig3, inputs=("record*", "gfrf*"), outputs=("png", "pdf"))
