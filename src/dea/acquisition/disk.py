"""Whether the disk can take a record of known length: found out before any voltage."""

import os
import shutil
import tempfile
from pathlib import Path

from dea.errors import InputError

# Of each sample: the row of the partial file, and what the record and the log of the link hold,
# with every exchange of a polled drive.
BYTES = 64 + 400
SPARE = 10_000_000  # bytes that a disk is left with


def refuse_without_room(file: Path, samples: int) -> None:
    """Refuse a drive whose record ``file`` cannot be written beside its partial file.

    Raises
    ------
    InputError
        Where the folder cannot be made or written to, or the disk has not as many bytes left as
        ``samples`` need.
    """
    folder = file.parent
    while not folder.exists():
        folder = folder.parent
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(
            f"cannot be written: {folder}: {os.strerror(error.errno or 0)}",
            file=file,
            remedy="Name another folder, or get the right to write there.",
        ) from error
    needed, free = BYTES * samples + SPARE, shutil.disk_usage(folder).free
    if free < needed:
        raise InputError(
            f"{samples} samples need {needed / 1e6:.0f} MB, and the disk of {folder} has "
            f"{free / 1e6:.0f} MB left",
            file=file,
            remedy="Make room, or record to another disk.",
        )
