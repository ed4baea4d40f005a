"""Copy files to other names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def copy_files(settings: Mapping[str, Any], originals: list[Path], copies: list[Path]) -> None:
    """Copy each of ``originals`` to its place in ``copies``."""
    import shutil

    from dea.atomic_file import atomic

    for original, copy in zip(originals, copies, strict=True):
        with atomic(copy) as partial:
            shutil.copyfile(original, partial)


if __name__ == "__main__":
    run(copy_files, inputs=("originals*",), outputs=("copies*",))
