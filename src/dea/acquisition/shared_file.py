"""Files by which programs on this machine share a device, whoever runs them."""

import os
import re
import socket
from pathlib import Path

from dea.modbus import Device

# In memory (tmpfs), so that no disk can delay a guardian. Not the folder of TMPDIR, which users and
# programs set as they like: all who share a device must find the same file.
FOLDERS = Path("/dev/shm"), Path("/tmp")
OWN_FOLDER = "DEA_DUTY"  # instead of these


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
        try:
            host = socket.gethostbyname(device.host)
        except OSError:  # the connection will say so
            host = device.host
        place = f"{host}:{device.port}"
    return f"{place} unit {device.unit_id}"


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
