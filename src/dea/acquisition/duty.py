"""Who guards an output, and the voltage last asked for: readable while it runs and after a crash.

The file's lock is held as long as the guardian lives; there is one for each output of each device
on this machine (:mod:`dea.acquisition.shared_file`).
"""

import fcntl
import mmap
import os
import struct
import time
from enum import IntEnum
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from dea.acquisition.shared_file import open_shared, shared_file
from dea.errors import InputError
from dea.modbus import Device

# Process, phase, order, token, requested V, time of the last change.
_LAYOUT = struct.Struct("<qBBIdd")
_ORDER = struct.calcsize("<qB")


class Phase(IntEnum):
    """What a guardian is doing, or was doing when it ended."""

    NEVER = 0
    CHECKING = 1
    DRIVING = 2
    TO_ZERO = 3
    ALARM = 4
    AT_ZERO = 5
    DISMISSED = 6


class Order(IntEnum):
    """What somebody else asks of a guardian."""

    NONE = 0
    ZERO = 1
    DISMISS = 2


# One that was dismissed, too: the amplifier was switched off, and the module may hold its voltage.
DANGEROUS = (Phase.DRIVING, Phase.TO_ZERO, Phase.ALARM, Phase.DISMISSED)


class Notice(NamedTuple):
    """The state of an output: its guardian's process, whether it lives, what it last asked for.

    ``token`` is what it claimed the device with; ``requested`` in V; ``changed`` in s since the
    epoch.
    """

    process: int
    alive: bool
    phase: Phase
    token: int
    requested: float
    changed: float

    @property
    def abandoned(self) -> bool:
        """Whether a guardian ended before it had taken its output to zero."""
        return not self.alive and self.phase in DANGEROUS


class Duty:
    """The right to guard an output: the lock on its file, and what the file says.

    Raises
    ------
    InputError
        On entry, where another guardian is on duty.
    """

    def __init__(self, device: Device) -> None:
        self.device, self.path = device, duty_file(device)

    def __enter__(self) -> Self:
        handle = _open(self.path)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise InputError(
                "another acquisition on this machine drives the output",
                file=self.device.source,
                field="endpoint",
                remedy="End it, or see `python -m dea.acquisition status`.",
            ) from None
        self._handle, self._map = handle, mmap.mmap(handle, _LAYOUT.size)
        self.before = _notice(self._map[:], alive=False)
        self.token = self.before.token
        phase = self.before.phase if self.before.abandoned else Phase.CHECKING
        self.put(phase, self.before.requested)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._map.close()
        os.close(self._handle)

    @property
    def order(self) -> Order:
        """What somebody has asked of this guardian."""
        return Order(self._map[_ORDER])

    def put(self, phase: Phase, requested: float) -> None:
        """Note the phase and the voltage asked for, V."""
        asked, now = self._map[_ORDER], time.time()
        _LAYOUT.pack_into(self._map, 0, os.getpid(), phase, asked, self.token, requested, now)

    def clear_order(self) -> None:
        """Forget what was asked of an earlier guardian."""
        self._map[_ORDER] = Order.NONE


def look(path: Path) -> Notice:
    """Return what the file of an output (:func:`duty_file`) says."""
    if not path.exists():
        return Notice(0, False, Phase.NEVER, 0, 0.0, 0.0)
    return _notice(path.read_bytes(), alive=_locked(path))


def order(path: Path, asked: Order) -> None:
    """Ask something of the guardian that has this file."""
    handle = _open(path)
    with mmap.mmap(handle, _LAYOUT.size) as shared:
        shared[_ORDER] = asked
    os.close(handle)


def duty_file(device: Device) -> Path:
    """Return the file of an output: one for each endpoint, unit and register."""
    return shared_file(device, "duty", str(device["output"].address))


def _open(path: Path) -> int:
    handle = open_shared(path)
    if os.fstat(handle).st_size < _LAYOUT.size:
        os.ftruncate(handle, _LAYOUT.size)
    return handle


def _locked(path: Path) -> bool:
    handle = _open(path)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(handle)
    return False


def _notice(data: bytes, *, alive: bool) -> Notice:
    process, phase, _, token, requested, changed = _LAYOUT.unpack_from(data)
    return Notice(process, alive, Phase(phase), token, requested, changed)
