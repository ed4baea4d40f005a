"""Fig. 1: the bench and one actuator's record."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def fig1(settings: Mapping[str, Any], record: Path, png: Path, pdf: Path) -> None:
    """Draw it from the system's own datasets."""
    from dea import store
    from dea.figures import style
    from dea.figures.fig1 import fig1 as draw

    figure = draw(store.read_record(record), settings["system"], settings["figures"]["zoom"])
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(fig1, inputs=("record",), outputs=("png", "pdf"))
