"""Draw figures that share their files."""

import gc
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def figures(
    settings: Mapping[str, Any], sources: list[Path], png: list[Path], pdf: list[Path]
) -> None:
    """Draw each figure of ``settings["figures"]`` at the paths of its place.

    These are pairs of a name and its options: settings are kept with their keys in order. A figure
    is the function ``draw`` of the module of its name in :mod:`dea.figures`.
    """
    from importlib import import_module

    from matplotlib.figure import Figure

    from dea import store
    from dea.figures import style

    found = store.Sources(sources)
    for (name, options), *paths in zip(settings["figures"], png, pdf, strict=True):
        gc.collect(1)  # the figure before, a hundred megabytes, whose parts refer to each other
        draw: Callable[..., Figure] = import_module(f"dea.figures.{name}").draw
        style.save(draw(found, **options), paths, settings["resolution"])


if __name__ == "__main__":
    # Figures are collected once they are saved; automatic collections took a tenth of the time.
    gc.disable()
    run(figures, inputs=("sources*",), outputs=("png*", "pdf*"))
