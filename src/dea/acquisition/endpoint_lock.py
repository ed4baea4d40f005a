"""One user of a device at a time on this computer, also where it has no register `claim`."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from dea.acquisition.shared_file import GLANCE, SharedLock, endpoint, shared_file
from dea.errors import InputError
from dea.modbus import Device


@contextmanager
def endpoint_lock(
    device: Device, patience: float = GLANCE, meanwhile: Callable[[], None] = lambda: None
) -> Iterator[SharedLock]:
    """Keep other programs of this project from driving ``device`` until the block ends.

    One that has it is given ``patience`` s to end; ``meanwhile`` is called until then.

    The lock goes with the process that holds it, however it ends. Where its file may be removed
    meanwhile, ``keep`` of it is called from time to time.

    Raises
    ------
    InputError
        If another process drives the device; the message names it.
    """
    with SharedLock(shared_file(device, "lock")) as lock:
        if not lock.take(patience, meanwhile):
            holder = lock.holder()
            raise InputError(
                f"{endpoint(device)} is driven by another program on this computer"
                + (f" (process {holder})" if holder else ""),
                file=device.source,
                field="endpoint",
                remedy="Wait until it has ended, or stop it",
            )
        with suppress(OSError):  # it only tells others whose it is
            lock.write(f"{os.getpid()}\n")
        yield lock
