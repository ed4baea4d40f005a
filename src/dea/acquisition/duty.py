"""Who guards an output, and the voltage last asked for: readable while it runs and after a crash.

The file's lock is held as long as the guardian lives; there is one for each output of each device
on this machine (:mod:`dea.acquisition.shared_file`).
"""

import fcntl
import mmap
import os
import signal
import struct
import time
from enum import IntEnum
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from dea.acquisition.shared_file import SharedLock, open_shared, shared_file
from dea.errors import InputError
from dea.modbus import Device

# Process, phase, order, token, requested V, time of the last change since the epoch and by the
# monotonic clock.
_LAYOUT = struct.Struct("<qBBIddd")
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
# In these it changes its notice all the time, at the least between two requests.
ACTIVE = (Phase.DRIVING, Phase.TO_ZERO, Phase.ALARM)


class Notice(NamedTuple):
    """The state of an output: its guardian's process, whether it lives, what it last asked for.

    ``token`` is what it claimed the device with; ``requested`` in V; ``changed`` in s since the
    epoch; ``beat`` the same time by the monotonic clock.
    """

    process: int
    alive: bool
    phase: Phase
    token: int
    requested: float
    changed: float
    beat: float

    @property
    def silent(self) -> float:
        """For how many s a guardian that must be active has given no sign of life."""
        return time.monotonic() - self.beat if self.alive and self.phase in ACTIVE else 0.0

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
        self.device = device
        self._lock = SharedLock(duty_file(device))

    def __enter__(self) -> Self:
        if not self._lock.take():
            raise InputError(
                "another acquisition on this machine drives the output",
                file=self.device.source,
                field="endpoint",
                remedy="End it, or see `python -m dea.acquisition status`.",
            )
        self._map = _mapped(self._lock.handle)
        self.before = _notice(self._map[:], alive=False)
        self.token = self.before.token
        phase = self.before.phase if self.before.abandoned else Phase.CHECKING
        self.put(phase, self.before.requested)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._map.close()
        self._lock.close()

    def keep(self) -> bool:
        """Make the file anew where it was removed; return whether nobody else has the duty."""
        before, said = self._lock.handle, self._map[:]
        if not self._lock.keep():
            return False
        if self._lock.handle != before:
            self._map.close()
            self._map = _mapped(self._lock.handle)
            self._map[:] = said
        return True

    @property
    def order(self) -> Order:
        """What somebody has asked of this guardian."""
        return Order(self._map[_ORDER])

    def put(self, phase: Phase, requested: float) -> None:
        """Note the phase and the voltage asked for, V."""
        times = time.time(), time.monotonic()
        asked = self._map[_ORDER]
        _LAYOUT.pack_into(self._map, 0, os.getpid(), phase, asked, self.token, requested, *times)

    def clear_order(self) -> None:
        """Forget what was asked of an earlier guardian."""
        self._map[_ORDER] = Order.NONE


def look(path: Path) -> Notice:
    """Return what the file of an output (:func:`duty_file`) says."""
    if not path.exists():
        return Notice(0, False, Phase.NEVER, 0, 0.0, 0.0, 0.0)
    return _notice(path.read_bytes(), alive=_locked(path))


def glance(path: Path, process: int) -> Notice | None:
    """Return what the file says, without its lock, if it is of the guardian ``process``.

    None where the file is not there, or is another's.
    """
    try:
        notice = _notice(path.read_bytes(), alive=True)
    except (OSError, struct.error):
        return None
    return notice if notice.process == process else None


def order(path: Path, asked: Order) -> None:
    """Ask something of the guardian that has this file."""
    handle = open_shared(path)
    with _mapped(handle) as shared:
        shared[_ORDER] = asked
    os.close(handle)


def end(process: int) -> None:
    """Kill a guardian that gives no sign of life; somebody else takes the output to zero then.

    Raises
    ------
    InputError
        Where it is another user's.
    """
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass
    except PermissionError:
        raise InputError(
            f"the guardian, process {process}, gives no sign of life and is another user's",
            remedy=f"End it with `sudo kill -KILL {process}`, then take the output to zero.",
        ) from None


def duty_file(device: Device) -> Path:
    """Return the file of an output: one for each endpoint, unit and register."""
    return shared_file(device, "duty", str(device["output"].address))


def _mapped(handle: int) -> mmap.mmap:
    if os.fstat(handle).st_size < _LAYOUT.size:
        os.ftruncate(handle, _LAYOUT.size)
    return mmap.mmap(handle, _LAYOUT.size)


def _locked(path: Path) -> bool:
    handle = open_shared(path)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(handle)
    return False


def _notice(data: bytes, *, alive: bool) -> Notice:
    process, phase, _, token, requested, changed, beat = _LAYOUT.unpack_from(data)
    return Notice(process, alive, Phase(phase), token, requested, changed, beat)
