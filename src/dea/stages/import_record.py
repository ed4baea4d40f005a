"""Read a record made elsewhere, as its case file names it, into ``record.nc``."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def import_record(settings: Mapping[str, Any], case: Path, place: Path, record: Path) -> None:
    """Import the record that a case file describes at a ``place``, its dotted key."""
    from dea import store

    dataset = store.import_record(settings, case, place=str(place))
    store.write(
        dataset,
        record,
        title=f"Record of the case {case.stem}",
        inputs={"record": settings["file"]},
        settings=settings,
    )


if __name__ == "__main__":
    # What the case says of the record is in the settings.
    run(import_record, mentioned=("case", "place"), outputs=("record",), named=("file",))
