"""One user of a device at a time on this computer, whether or not the device keeps its owner."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager

from dea.acquisition.shared_file import endpoint, open_shared, shared_file
from dea.errors import InputError
from dea.modbus import Device


@contextmanager
def endpoint_lock(device: Device) -> Iterator[None]:
    """Keep other programs of this project from driving ``device`` until the block ends.

    The lock goes with the process that holds it, however it ends.

    Raises
    ------
    InputError
        If another process drives the device; the message names it.
    """
    handle = open_shared(shared_file(device, "lock"))
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(handle, 100, 0).decode(errors="replace").strip()
            raise InputError(
                f"{endpoint(device)} is driven by another program on this computer"
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
