"""The first trip of a drive, kept by a thread of its own: a disk may hang, zero may not wait."""

import time
from contextlib import suppress
from pathlib import Path
from threading import Thread

from dea.acquisition.latch import hold, latch, release, utc_now
from dea.modbus import Device

AGAIN = 0.5  # s between two attempts to keep a trip


class FirstTrip:
    """Keeps one trip of a device as it happens: in memory, and at ``path`` once the disk takes it.

    ``failure`` is why the disk has not taken it, where it has said so.
    """

    def __init__(self, device: Device, path: Path) -> None:
        self._device, self._path = device, path
        self._trip: Exception | None = None
        self._when = ""
        self._latching: Thread | None = None
        self._kept = False
        self.failure: Exception | None = None

    def latch(self, trip: Exception | None = None, when: str = "") -> None:
        """Latch a trip unless there was one before; try again where no thread could be started.

        It happens now where ``when`` does not say that it did earlier.
        """
        if self._trip is None and trip is not None:
            self._trip, self._when = trip, when or utc_now()
        if self._trip is not None and self._latching is None:
            latching = Thread(target=self._keep, daemon=True)
            with suppress(RuntimeError):  # the host starts no threads
                latching.start()
                self._latching = latching

    @property
    def pending(self) -> Exception | None:
        """The trip that is not on the disk yet."""
        return None if self._kept else self._trip

    def _keep(self) -> None:
        reason = str(self._trip)
        while not self._kept:
            try:
                with suppress(OSError):  # no memory is left: the disk may still take it
                    hold(self._device, reason, self._when)
                latch(self._path, self._device.name, reason, self._when)
                self._kept = True
            except Exception as error:  # whatever it is, the trip is not kept
                self.failure = error
                time.sleep(AGAIN)
        with suppress(OSError):  # what is held besides can only keep the output at zero
            release(self._device)
