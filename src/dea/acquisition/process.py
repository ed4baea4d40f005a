"""A process by a handle, which no later process with the same number takes over."""

import os
import signal
from contextlib import suppress


class Process:
    """A process that lives, to be killed if need be.

    Where the system gives no such handle it is its number.

    Raises
    ------
    ProcessLookupError
        Where there is none.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        try:
            self._handle = os.pidfd_open(number)
        except ProcessLookupError:
            raise
        except (AttributeError, OSError):  # not Linux, an old one, or no handle is left
            self._handle = -1

    def kill(self) -> None:
        """Kill it; raises PermissionError where it is another user's."""
        with suppress(ProcessLookupError):
            if self._handle >= 0:
                signal.pidfd_send_signal(self._handle, signal.SIGKILL)
            else:
                os.kill(self.number, signal.SIGKILL)

    def close(self) -> None:
        """Give the handle back."""
        if self._handle >= 0:
            os.close(self._handle)
        self._handle = -1
