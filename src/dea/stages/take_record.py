"""Take a record of hardware from ``records/`` into the study."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def take_record(settings: Mapping[str, Any], manifest: Path, record: Path, link: Path) -> None:
    """Compare a record's files with its manifest and copy the record and the log of its link."""
    import shutil

    from dea import archive, store

    folder = manifest.parent
    archive.finish(folder)
    for name, path in (("record.nc", record), ("link.nc", link)):
        with store.atomic(path) as partial:
            shutil.copyfile(folder / name, partial)


if __name__ == "__main__":
    run(take_record, inputs=("manifest",), outputs=("record", "link"))
