"""Records of hardware: ``records/NAME/TIME/``, read-only, each with a manifest.

Nothing here deletes or overwrites, but for the samples that a whole record was made from. A folder
takes its name when it is whole; one that an acquisition has left unfinished keeps the suffix
``.partial``.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dea.atomic_file import atomic, sync, sync_folder
from dea.checksum import sha256
from dea.errors import InputError

ROOT = Path("records")
MANIFEST = "manifest.json"
UNFINISHED = ".partial"
SAMPLES = "samples.partial"  # what a record is made from
FAULT = "fault"  # key of a manifest: why no sample of the record is good


def finished(name: str, excitation: str, root: Path = ROOT) -> list[Path]:
    """Return the folders of the records of an actuator with this excitation, oldest first.

    Raises
    ------
    InputError
        If a folder has no readable manifest.
    """
    folders = _folders(root / name)
    return [folder for folder in folders if manifest(folder)["excitation"] == excitation]


def chosen(name: str, excitation: str, pinned: str | None = None, root: Path = ROOT) -> Path:
    """Return the folder of the record to study: the one ``pinned``, or else the newest.

    Raises
    ------
    InputError
        If there is none; the remedy names the command that acquires it.
    """
    folders = finished(name, excitation, root)
    command = f"make record NAME={name} EXCITATION={excitation}"
    if pinned is not None:
        if root / name / pinned in folders:
            return root / name / pinned
        raise InputError(
            f"there is no record {pinned!r} of the excitation {excitation!r}",
            file=root / name,
            remedy=f"Name one of {', '.join(f.name for f in folders)}"
            if folders
            else f"Acquire it: {command}",
        )
    if not folders:
        raise InputError(
            f"there is no record of {name} with the excitation {excitation!r}",
            file=root / name,
            remedy=f"Acquire it: {command}",
        )
    return folders[-1]


def manifest(folder: Path) -> dict[str, Any]:
    """Return what a record's manifest says.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    file = folder / MANIFEST
    try:
        content = json.loads(file.read_text())
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read ({error})", file=file, remedy="Bring it back from a backup"
        ) from error
    if (
        not isinstance(content, dict)
        or "excitation" not in content
        or not isinstance(content.get("files"), dict)
    ):
        raise InputError(
            "is no manifest of a record", file=file, remedy="Bring it back from a backup"
        )
    return content


def check(folder: Path) -> dict[str, Any]:
    """Compare the files of a record with its manifest, which is returned.

    Raises
    ------
    InputError
        Naming the first file that is missing or holds something else.
    """
    content = manifest(folder)
    for name, expected in content["files"].items():
        file = folder / name
        if not file.is_file():
            raise InputError("is missing", file=file, remedy="Bring it back from a backup")
        if sha256(file) != expected:
            raise InputError(
                f"is not what was recorded (SHA-256 {expected[:12]}…)",
                file=file,
                remedy="Bring it back from a backup",
            )
    return content


@contextmanager
def unfinished(name: str, root: Path = ROOT, now: datetime | None = None) -> Iterator[Path]:
    """Yield a new folder for a record of ``name`` that starts now; :func:`seal` finishes it.

    Where the block fails, the folder stays with what it holds, and is removed only if empty; so is
    that of ``name``.

    Raises
    ------
    InputError
        If there is one of the same second already, or of a later time: the newest would not be the
        last, so the clock is wrong, or was.
    """
    time = (now or datetime.now(UTC)).strftime("%Y%m%dT%H%M%SZ")
    folder = root / name / f"{time}{UNFINISHED}"
    if folder.with_suffix("").exists():
        raise InputError("exists already", file=folder.with_suffix(""), remedy="Start it again")
    if later := [path for path in _folders(root / name) if path.name > time]:
        raise InputError(
            f"is of a later time than now, {time}",
            file=later[-1],
            remedy="Correct the clock; where it was wrong then, give the folder its true time",
        )
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        raise InputError(
            "another record starts at this moment", file=folder, remedy="Start it again"
        ) from None
    try:
        yield folder
    finally:
        for empty in (folder, folder.parent):
            with suppress(OSError):
                empty.rmdir()


def seal(folder: Path, content: Mapping[str, Any]) -> Path:
    """Write the manifest of an unfinished record, make it read-only, and give it its name.

    All of it is on the disk then. The samples are removed once the record has its name: a failure
    or a crash at any moment leaves one of the two.

    Parameters
    ----------
    content
        What the manifest says; the SHA-256 of every file is added.

    Returns
    -------
    Path
        The folder under its final name.

    Raises
    ------
    OSError
        Where the disk does not take it; the folder stays unfinished.
    """
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != SAMPLES)
    for path in files:
        sync(path)
    digests = {path.name: sha256(path) for path in files}
    text = json.dumps({**content, "files": digests}, indent=1, sort_keys=True)
    with atomic(folder / MANIFEST) as partial:
        partial.write_text(f"{text}\n")
    for path in folder.iterdir():
        path.chmod(0o444)
    final = folder.with_suffix("")
    folder.rename(final)
    sync_folder(final.parent)
    (final / SAMPLES).unlink(missing_ok=True)
    final.chmod(0o555)
    return final


def finish(folder: Path) -> dict[str, Any]:
    """Compare a record with its manifest, which is returned, and end what :func:`seal` began.

    A crash may have left the samples in a folder that has its name already. They are removed only
    where all files agree with the manifest.

    Raises
    ------
    InputError
        As :func:`check`.
    """
    content = check(folder)
    samples = folder / SAMPLES
    if samples.exists():
        samples.unlink()
        folder.chmod(0o555)
    return content


def _folders(of_actuator: Path) -> list[Path]:
    return sorted(path for path in of_actuator.glob("*Z") if path.is_dir())
