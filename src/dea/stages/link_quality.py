"""How the acquisition of every actuator went."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def link_quality(settings: Mapping[str, Any], link: list[Path], png: Path, pdf: Path) -> None:
    """Draw it; a dataset's folder is the system's name."""
    from dea import store
    from dea.figures import style
    from dea.figures.link import link as draw

    figure = draw({path.parent.name: store.read(path) for path in link})
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(link_quality, inputs=("link*",), outputs=("png", "pdf"))
