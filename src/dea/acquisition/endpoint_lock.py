"""One user of a device at a time on this computer, whether or not the device keeps its owner."""

import fcntl
import os
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

from dea.errors import InputError
from dea.modbus import Device

# Of the computer and not of a user: two users share the devices, but not their home folders.
FOLDER = Path(tempfile.gettempdir())


@contextmanager
def endpoint_lock(device: Device) -> Iterator[None]:
    """Keep other programs of this project from driving ``device`` until the block ends.

    The lock goes with the process that holds it, however it ends.

    Raises
    ------
    InputError
        If another process drives the device; the message names it.
    """
    endpoint = _endpoint(device)
    file = FOLDER / f"dea-study-{sha256(endpoint.encode()).hexdigest()[:16]}.lock"
    handle = _open(file)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(handle, 100, 0).decode(errors="replace").strip()
            raise InputError(
                f"{endpoint} is driven by another program on this computer"
                + (f" (process {holder})" if holder else ""),
                file=device.source,
                field="endpoint",
                remedy="Wait until it has ended, or stop it",
            ) from None
        os.truncate(handle, 0)
        os.pwrite(handle, f"{os.getpid()}\n".encode(), 0)
        yield
    finally:
        os.close(handle)


def _open(file: Path) -> int:
    # Where the file is another user's, a kernel may refuse to open it with O_CREAT.
    try:
        return os.open(file, os.O_RDWR | os.O_CLOEXEC)
    except FileNotFoundError:
        handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        os.fchmod(handle, 0o666)  # whatever the umask
        return handle


def _endpoint(device: Device) -> str:
    """Return what two descriptions of one output share."""
    if device.serial is not None:
        place = str(Path(device.serial.port).resolve())
    else:
        try:
            host = socket.gethostbyname(device.host)
        except OSError:  # the connection will say so
            host = device.host
        place = f"{host}:{device.port}"
    return f"{place} unit {device.unit_id}"
