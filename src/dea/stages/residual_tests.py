"""Residual correlation tests of one system."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def residual_tests(settings: Mapping[str, Any], validation: Path, png: Path, pdf: Path) -> None:
    """Draw it from the system's own datasets."""
    from dea import store
    from dea.figures import style
    from dea.figures.residual_tests import residual_tests as draw

    figure = draw(store.read(validation), settings["system"])
    style.save(figure, (png, pdf), settings["figures"]["resolution"])


if __name__ == "__main__":
    run(residual_tests, inputs=("validation",), outputs=("png", "pdf"))
