"""An alarm, shown and sounded, that a blocked terminal, pipe or log does not delay."""

import os
import syslog
import threading
import time
from collections.abc import Callable
from contextlib import suppress

INTERVAL = 5.0  # s between two alarms
BELL = "\a"


class Alarm:
    """Repeats a message on standard error, the terminal and the system's log.

    Each is written by a thread of its own: a stopped terminal or a full pipe holds up that thread.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._last = -INTERVAL
        self._writers: dict[str, threading.Thread] = {}

    def __call__(self, message: str) -> bool:
        """Raise it, at most every INTERVAL seconds; return whether it was."""
        if time.monotonic() - self._last < INTERVAL:
            return False
        self._last = time.monotonic()
        line = f"ALARM: {self.name}: {message}"
        self._start("standard error", lambda: os.write(2, f"{BELL}{line}\n".encode()))
        self._start("log", lambda: syslog.syslog(syslog.LOG_ALERT, line))
        return True

    def join(self, seconds: float) -> None:
        """Wait until it has been written, for so long at most."""
        end = time.monotonic() + seconds
        for writer in self._writers.values():
            with suppress(RuntimeError):  # it was never started
                writer.join(max(end - time.monotonic(), 0.0))

    def _start(self, where: str, write: Callable[[], object]) -> None:
        writer = self._writers.get(where)
        if writer is None or not writer.is_alive():
            self._writers[where] = threading.Thread(target=_quietly, args=(write,), daemon=True)
            with suppress(RuntimeError):  # the host starts no threads: the other is told
                self._writers[where].start()


def _quietly(write: Callable[[], object]) -> None:
    with suppress(OSError):  # nobody there to read it; the others are told
        write()
