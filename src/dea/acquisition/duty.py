"""Who guards an output, and what was last asked for: readable while it runs and after a crash.

The file's lock is held as long as the guardian lives; there is one for each output of each device
on this machine (:mod:`dea.acquisition.shared_file`).
"""

import mmap
import os
import struct
import time
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import numpy as np

from dea.acquisition.command_line import typed
from dea.acquisition.process import Process
from dea.acquisition.shared_file import GLANCE, SharedLock, is_locked, open_shared, shared_file
from dea.errors import InputError
from dea.modbus import Device, representable, to_counts, to_physical

# Process, phase, order, token, requested V, time of the last change since the epoch, the same by
# the monotonic clock, requested counts, s without a sign of life that mean that something is wrong.
_LAYOUT = struct.Struct("<qBBIdddqd")
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
    UNKEPT = 7  # at zero, with a trip that the disk has not taken
    REFUSED = 8  # before it had driven anything


class Order(IntEnum):
    """What somebody else asks of a guardian."""

    NONE = 0
    ZERO = 1
    DISMISS = 2


# One that was dismissed, too: the amplifier was switched off, and the module may hold its voltage.
DANGEROUS = (Phase.DRIVING, Phase.TO_ZERO, Phase.ALARM, Phase.DISMISSED)
ALARMING = (Phase.ALARM, Phase.UNKEPT)  # until a person dismisses the guardian


class Notice(NamedTuple):
    """The state of an output: its guardian's process, whether it lives, what it last asked for.

    ``token`` is what it claimed the device with; ``requested`` in V, as the description said that
    it was driven with, and ``counts`` the same as it was written, None where an earlier version of
    this program has not kept it; ``changed`` in s since the epoch; ``beat`` the same time by the
    monotonic clock; ``patience`` s without a sign of life are more than a guardian at work needs.
    """

    process: int
    alive: bool
    phase: Phase
    token: int
    requested: float
    changed: float
    beat: float
    counts: int | None
    patience: float

    @property
    def silent(self) -> float:
        """For how many s a guardian that lives has given no sign of life."""
        return max(time.monotonic() - self.beat, 0.0) if self.alive else 0.0

    @property
    def abandoned(self) -> bool:
        """Whether a guardian ended before it had taken its output to zero."""
        return not self.alive and self.phase in DANGEROUS


_NOBODY = Notice(0, False, Phase.NEVER, 0, 0.0, 0.0, 0.0, None, 0.0)


class Duty:
    """The right to guard an output: the lock on its file, and what the file says.

    Parameters
    ----------
    waits, meanwhile
        For how many s one that has the duty may take to end, and what is called until then.
    patience
        What the file says of it, see :class:`Notice`.

    Raises
    ------
    InputError
        On entry, where another guardian is on duty.
    """

    def __init__(
        self,
        device: Device,
        *,
        waits: float = GLANCE,
        meanwhile: Callable[[], None] = lambda: None,
        patience: float = 0.0,
    ) -> None:
        self.device, self._patience = device, patience
        self._waits, self._meanwhile = waits, meanwhile
        self._lock = SharedLock(duty_file(device))
        self._last = Phase.CHECKING, 0.0

    def __enter__(self) -> Self:
        if not self._lock.take(self._waits, self._meanwhile):
            raise InputError(
                "another acquisition on this machine drives the output",
                file=self.device.source,
                field="endpoint",
                remedy=f"End it, or see `{typed('status', self.device)}`.",
            )
        self.before = _notice(os.pread(self._lock.handle, _LAYOUT.size, 0), alive=False)
        self._map, self._written = _mapped(self._lock.handle), self._lock.handle
        self.token = self.before.token
        phase = self.before.phase if self.before.abandoned else Phase.CHECKING
        self.put(phase, self.left)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._map.close()
        self._lock.close()

    @property
    def left(self) -> float:
        """What the guardian before asked for last, V, within the limits of this description.

        Another description may give the same counts another voltage.
        """
        volts, counts = self.before.requested, self.before.counts
        if counts is not None:
            volts = float(to_physical(self.device["output"], counts))
        return within_limits(self.device, volts)

    @property
    def order(self) -> Order:
        """What somebody has asked of this guardian."""
        asked = self._map[_ORDER]
        return Order(asked) if asked in set(Order) else Order.NONE

    def put(self, phase: Phase, requested: float) -> None:
        """Note the phase and the voltage asked for, V."""
        self._last = phase, requested
        output = self.device["output"]
        count = int(to_counts(output, np.clip(requested, *representable(output))))
        said = _LAYOUT.pack(
            os.getpid(), phase, 0, self.token, requested, time.time(), time.monotonic(), count,
            self._patience,
        )  # fmt: skip
        # Whole parts at once, around the order, which somebody else writes.
        self._map[:_ORDER] = said[:_ORDER]
        self._map[_ORDER + 1 :] = said[_ORDER + 1 :]

    def beat(self) -> None:
        """Give a sign of life."""
        self.put(*self._last)

    def clear_order(self) -> None:
        """Forget what was asked of an earlier guardian."""
        self._map[_ORDER] = Order.NONE

    def keep(self) -> bool:
        """Make the file anew where it was removed; return whether nobody else has the duty."""
        if not self._lock.keep():
            return False
        if self._lock.handle != self._written:
            with suppress(OSError):  # of a host without memory: tried again
                new = _mapped(self._lock.handle)
                new[:] = self._map[:]
                self._map.close()
                self._map, self._written = new, self._lock.handle
        return True


def look(path: Path) -> Notice:
    """Return what the file of an output (:func:`duty_file`) says."""
    try:
        before = path.read_bytes()
        alive = is_locked(path)
        after = path.read_bytes()
    except FileNotFoundError:
        return _NOBODY
    # Read again if the process changed: another guardian has come meanwhile.
    same = _notice(before, alive=alive).process == _notice(after, alive=alive).process
    return _notice(after, alive=alive) if same else look(path)


def order(path: Path, asked: Order) -> None:
    """Ask something of the guardian that has this file."""
    handle = open_shared(path)
    # No longer than it is: its length says which version of this program has written it.
    os.pwrite(handle, bytes([asked]), _ORDER)
    os.close(handle)


def end(path: Path, judged: Notice) -> bool:
    """Kill the guardian that was judged to give no sign of life; return whether it did.

    Not one that has given any since. Whoever calls this takes the output to zero.

    Raises
    ------
    InputError
        Where it is another user's.
    """
    try:
        process = Process(judged.process)
    except ProcessLookupError:
        return False
    try:
        # The number may be another process's by now.
        if not _has_open(judged.process, path) or look(path) != judged:
            return False
        process.kill()
    except PermissionError:
        raise InputError(
            f"the guardian, process {judged.process}, gives no sign of life and is another user's",
            remedy=f"End it with `sudo kill -KILL {judged.process}`, then repeat this.",
        ) from None
    finally:
        process.close()
    return True


def within_limits(device: Device, volts: float) -> float:
    """Return a voltage within the limits of a device's output."""
    output = device["output"]
    low, high = output.limits or representable(output)
    return float(np.clip(volts, low, high))


def duty_file(device: Device) -> Path:
    """Return the file of an output: one for each endpoint, unit and register."""
    return shared_file(device, "duty", str(device["output"].address))


def _has_open(process: int, path: Path) -> bool:
    folder = Path(f"/proc/{process}/fd")
    if not folder.exists():  # a system without /proc, or it has ended
        return not folder.parents[1].exists()
    for handle in folder.iterdir():
        with suppress(FileNotFoundError):
            if os.path.samestat(handle.stat(), path.stat()):
                return True
    return False


def _mapped(handle: int) -> mmap.mmap:
    if os.fstat(handle).st_size < _LAYOUT.size:
        # A page that there is no memory for would end the process when it is written.
        reserve = getattr(os, "posix_fallocate", lambda file, _, size: os.ftruncate(file, size))
        reserve(handle, 0, _LAYOUT.size)
    return mmap.mmap(handle, _LAYOUT.size)


def _notice(data: bytes, *, alive: bool) -> Notice:
    whole = data[: _LAYOUT.size].ljust(_LAYOUT.size, b"\0")
    process, phase, _, token, requested, changed, beat, count, patience = _LAYOUT.unpack(whole)
    known = Phase(phase) if phase in set(Phase) else Phase.ALARM
    counts = count if len(data) >= _LAYOUT.size else None
    return Notice(process, alive, known, token, requested, changed, beat, counts, patience)
