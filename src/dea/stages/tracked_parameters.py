"""Tracked parameters of one system, and what following them buys."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def tracked_parameters(
    settings: Mapping[str, Any], record: Path, track: Path, png: Path, pdf: Path
) -> None:
    """Draw it from the system's own datasets."""
    from dea import store
    from dea.figures import style
    from dea.figures.tracked_parameters import tracked_parameters as draw

    figure = draw(store.read_record(record), store.read(track), settings["system"])
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(tracked_parameters, inputs=("record", "track"), outputs=("png", "pdf"))
