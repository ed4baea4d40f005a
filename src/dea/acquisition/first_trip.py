"""The first trip of a drive, latched in a thread of its own: a disk may hang, zero may not wait."""

from contextlib import suppress
from pathlib import Path
from threading import Thread

from dea.acquisition.alarm import Alarm
from dea.acquisition.latch import latch


class FirstTrip:
    """Latches one trip of a device, in the file at ``path``, as it happens."""

    def __init__(self, path: Path, name: str, alarm: Alarm) -> None:
        self._path, self._name, self._alarm = path, name, alarm
        self._trip: Exception | None = None
        self._latching: Thread | None = None

    def latch(self, trip: Exception | None = None) -> None:
        """Latch a trip unless there was one before; try again where no thread could be started."""
        self._trip = self._trip or trip
        if self._trip is not None and self._latching is None:
            latching = Thread(target=self._write, daemon=True)
            with suppress(RuntimeError):  # the host starts no threads
                latching.start()
                self._latching = latching

    @property
    def pending(self) -> Exception | None:
        """The trip that is not kept yet."""
        kept = self._latching is not None and not self._latching.is_alive()
        return None if kept else self._trip

    def _write(self) -> None:
        try:
            latch(self._path, self._name, str(self._trip))
        except OSError as error:
            self._alarm(f"a trip ({self._trip}) could not be kept: {error}")
