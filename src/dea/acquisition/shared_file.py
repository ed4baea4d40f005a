"""Files by which programs on this machine share a device, whoever runs them."""

import fcntl
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

from dea.acquisition.address import address_of
from dea.modbus import Device

# In memory (tmpfs), so that no disk can delay a guardian. Not the folder of TMPDIR, which users and
# programs set as they like: all who share a device must find the same file.
FOLDERS = Path("/dev/shm"), Path("/tmp")
OWN_FOLDER = "DEA_DUTY"  # instead of these
# s for which a lock may be held by somebody who only looks whether it is, or who is about to end,
# and between attempts to take it.
GLANCE, AGAIN = 1.0, 0.02
BRIEFLY = 0.1  # s that a guardian at work can spare for it


def shared_file(device: Device, kind: str, detail: str = "", folder: Path | None = None) -> Path:
    """Return the file of a ``kind`` that belongs to a device, or to a ``detail`` of it."""
    shared = folder or next(each for each in FOLDERS if each.is_dir())
    name = "_".join([endpoint(device), detail]) if detail else endpoint(device)
    return Path(
        os.environ.get(OWN_FOLDER) or shared, f"dea_{kind}_{re.sub('[^A-Za-z0-9.-]+', '_', name)}"
    )


def endpoint(device: Device) -> str:
    """Return what all descriptions of one device share: its place and its unit."""
    if device.serial is not None:
        place = str(Path(device.serial.port).resolve())
    else:
        host = address_of(device.host) or device.host
        place = f"{host}:{device.port}"
    return f"{place} unit {device.unit_id}"


class SharedLock:
    """The lock on a shared file, kept even where the file is removed.

    What is in memory may be removed while a process still uses it, as when its user logs out
    (RemoveIPC of systemd-logind). A lock on a file without a name does not exclude other programs.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.handle = -1
        self._text = ""

    def take(self, patience: float = GLANCE, meanwhile: Callable[[], None] = lambda: None) -> bool:
        """Lock the file that has the name; return whether it was free within ``patience`` s.

        ``meanwhile`` is called while it is waited for.
        """
        end = time.monotonic() + patience
        while True:
            handle = open_shared(self.path)
            free = _locked(handle, fcntl.LOCK_EX)
            if free and _named(handle, self.path):
                before, self.handle = self.handle, handle
                if before >= 0:
                    os.close(before)
                return True
            os.close(handle)
            if not free and time.monotonic() > end:
                return False
            meanwhile()
            time.sleep(0.0 if free else AGAIN)

    def keep(self) -> bool:
        """Take the lock again where its file was removed; return whether nobody else has it.

        Where no file can be made, as where its folder is gone, nobody else can have one either.
        """
        try:
            if _named(self.handle, self.path):
                return True
            taken = self.take(BRIEFLY)
            if taken and self._text:
                self.write(self._text)
            return taken
        except OSError:
            return True

    def holder(self) -> str:
        """Return what the holder has written into the file."""
        return self.path.read_bytes()[:100].decode(errors="replace").strip()

    def write(self, text: str) -> None:
        """Write what others are told of the holder."""
        self._text = text
        os.truncate(self.handle, 0)
        os.pwrite(self.handle, text.encode(), 0)

    def close(self) -> None:
        """Give the lock back."""
        os.close(self.handle)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.handle >= 0:
            self.close()


def is_locked(path: Path) -> bool:
    """Return whether some process has the lock on a file."""
    handle = open_shared(path)
    try:
        return not _locked(handle, fcntl.LOCK_SH)  # two that look do not meet
    finally:
        os.close(handle)


def _locked(handle: int, kind: int) -> bool:
    try:
        fcntl.flock(handle, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _named(handle: int, path: Path) -> bool:
    """Return whether an open file still has its name."""
    try:
        return os.path.samestat(os.fstat(handle), os.stat(path))
    except FileNotFoundError:
        return False


def open_shared(path: Path) -> int:
    """Open a file for reading and writing, made for every user of the machine where it is new."""
    # Where the file is another user's, a kernel may refuse to open it with O_CREAT.
    try:
        return os.open(path, os.O_RDWR | os.O_CLOEXEC)
    except FileNotFoundError:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        if os.fstat(handle).st_uid == os.getuid():
            os.fchmod(handle, 0o666)  # whatever the umask
        return handle
