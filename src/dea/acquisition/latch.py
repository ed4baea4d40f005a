"""Trips of the safety model, kept on disk until somebody acknowledges them.

Every account of this computer finds the trip of a device, whatever its description calls the host.
"""

import errno
import json
import os
import stat
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from dea.acquisition.command_line import typed
from dea.acquisition.shared_file import open_shared, shared_file
from dea.atomic_file import atomic
from dea.errors import InputError
from dea.modbus import Device

# On a disk, unlike the files of locks: a trip outlives a restart of the computer. The folder has no
# sticky bit, with which only the account that kept a trip could delete, and so acknowledge, it.
FOLDER = Path("/var/tmp/dea")
# Readable whatever the umask. Programs that delete old temporary files spare one with a sticky bit.
_MODE = 0o666 | stat.S_ISVTX
_ROOM = 4096  # bytes that a trip takes on a disk


def latch(path: Path, device: str, reason: str, when: str) -> None:
    """Note a trip at :func:`latch_file`; its output is not driven until it is acknowledged.

    ``when`` it happened is as :func:`utc_now` says it.
    """
    with atomic(path) as partial:
        partial.write_text(_said(device, reason, when))
        partial.chmod(_MODE)


def hold(device: Device, reason: str, when: str) -> None:
    """Note a trip as :func:`latch`, but in memory: it binds all, until the computer is off.

    It does so where a disk is full, or hangs.

    Raises
    ------
    OSError
        Where no memory is left.
    """
    said = _said(device.name, reason, when).encode()
    handle = open_shared(held_file(device))
    try:
        os.pwrite(handle, said, 0)
        os.ftruncate(handle, len(said))
    finally:
        os.close(handle)


def release(device: Device) -> None:
    """Forget what :func:`hold` has noted."""
    # In a folder where each account deletes its own files alone, all may empty them.
    with suppress(FileNotFoundError):
        os.truncate(held_file(device), 0)


def held(device: Device) -> dict[str, str] | None:
    """Return the trip that is held in memory, as :func:`trip` does."""
    path = held_file(device)
    try:
        empty = not path.stat().st_size
    except FileNotFoundError:
        return None
    return None if empty else _read(path)


def refuse_latched(device: Device) -> None:
    """Refuse to drive an output whose trip nobody has acknowledged, or could not be kept.

    Raises
    ------
    InputError
        Naming the trip, or the folder that cannot be written.
    """
    refuse_tripped(device)
    if device.safety is not None:
        _refuse_without_folder(latch_file(device).parent)


def refuse_tripped(device: Device) -> None:
    """Refuse to drive an output whose trip nobody has acknowledged.

    Raises
    ------
    InputError
        Naming the trip.
    """
    tripped = trip(device)
    if tripped is not None:
        raise InputError(
            f"tripped at {tripped['time']}: {tripped['reason']}",
            file=device.source,
            field="safety",
            remedy=f"Find out why, then: {typed('acknowledge --by YOUR.NAME', device)}.",
        )


def trip(device: Device) -> dict[str, str] | None:
    """Return the trip that keeps an output from being driven: its ``time`` and ``reason``."""
    return _read(latch_file(device)) or held(device)


def _read(path: Path) -> dict[str, str] | None:
    try:
        content = json.loads(path.read_bytes())
        return {key: str(content[key]) for key in ("time", "reason")}
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        why = f"{path} is damaged and does not say why ({type(error).__name__}: {error})"
        return {"time": "an unknown time", "reason": why}


def acknowledge(device: Device, person: str) -> str | None:
    """Clear a trip; return its reason, or None where there is none. A log beside it keeps it.

    Raises
    ------
    InputError
        Where the person has no name.
    OSError
        Where the log cannot be written; the trip stays.
    """
    if not person.strip():
        raise InputError(
            "a trip is acknowledged by a person", field="by", remedy="Give your name: --by NAME"
        )
    path, in_memory = latch_file(device), held(device)
    kept = _identity(path)  # before it is read: a trip that replaces it since then is not cleared
    found = _read(path) or in_memory
    if found is None:
        return None
    # First, so that whatever ends this program clears no trip that the log does not hold.
    _log(path, found, person)
    if kept is not None:
        _clear(path, kept)
    if held(device) == in_memory:
        release(device)
    return found["reason"]


def _clear(path: Path, kept: tuple[int, int]) -> None:
    """Delete the trip with this identity, and no other that has its name by now."""
    # Under its own name a trip that happens meanwhile would be deleted with it.
    taken = path.with_name(f"{path.name}.{os.getpid()}")
    with suppress(FileNotFoundError):  # somebody else has acknowledged it too
        path.rename(taken)
        if _identity(taken) == kept:
            taken.unlink()
        else:
            taken.replace(path)


def _identity(path: Path) -> tuple[int, int] | None:
    """Return what tells a file from one that replaces it, or None where there is none."""
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return found.st_ino, found.st_mtime_ns


def _log(path: Path, found: dict[str, str], person: str) -> None:
    """Add the acknowledgement of a trip at ``path`` to the log beside it, on the disk."""
    line = json.dumps(found | {"acknowledged_by": person, "acknowledged": utc_now()}) + "\n"
    handle = open_shared(path.with_name(f"{path.name}.log"))
    try:
        end = os.lseek(handle, 0, os.SEEK_END)
        if os.write(handle, line.encode()) < len(line):  # all ASCII
            os.ftruncate(handle, end)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), f"{path}.log")
        os.fsync(handle)
        with suppress(PermissionError):  # another account has made it, with this mode
            os.fchmod(handle, _MODE)
    finally:
        os.close(handle)


def latch_file(device: Device) -> Path:
    """Return where a trip of a device is kept."""
    return shared_file(device, "trip", folder=FOLDER)


def held_file(device: Device) -> Path:
    """Return where a trip of a device is held that the disk has not taken."""
    return shared_file(device, "tripped")


def _refuse_without_folder(folder: Path) -> None:
    """Make the folder of trips for every account, or refuse."""
    try:
        folder.mkdir(parents=True)
        folder.chmod(0o777)
    except FileExistsError:
        pass
    except OSError as error:
        raise InputError(
            f"a trip could not be kept there ({error})",
            file=folder,
            remedy="Make it a folder to which all accounts that drive may write.",
        ) from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(
            "a trip could not be kept there: this account may not write to it",
            file=folder,
            remedy="Let every account that drives write to it: chmod a+rwx",
        )
    try:
        with tempfile.TemporaryFile(dir=folder) as trial:
            trial.write(bytes(_ROOM))
            trial.flush()
            os.fsync(trial.fileno())
    except OSError as error:
        raise InputError(
            f"a trip could not be kept there ({error.strerror})",
            file=folder,
            remedy="Make room on its disk.",
        ) from error


def _said(device: str, reason: str, when: str) -> str:
    return json.dumps({"device": device, "reason": reason, "time": when})


def utc_now() -> str:
    """Return the date and time as files keep it."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
