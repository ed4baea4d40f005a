"""A guardian before it has the locks of its output: it gives signs of life, and notes signals."""

import signal
import time
from typing import Any

from dea.acquisition.alarm import Alarm
from dea.acquisition.command_line import typed
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.first_trip import FirstTrip
from dea.acquisition.link_log import LinkLog
from dea.acquisition.retrying_link import Link
from dea.acquisition.wire import Wire
from dea.errors import InputError

BEAT = 0.5  # s between two signs of life


class Standby:
    """What a guardian has with or without the locks, however often it tries to take them.

    Parameters
    ----------
    wire
        The way to the recorder.
    job
        What is to be done.
    early
        Messages that came with the job.

    ``link`` is not open yet; ``signal`` names the last signal that asked for zero; ``started`` is
    in s by the monotonic clock.
    """

    def __init__(self, wire: Wire, job: DriveJob, early: list[tuple[Any, ...]]) -> None:
        self.wire, self.job, self.early = wire, job, early
        self.link = Link(job.device, job.settings, LinkLog(job.started))
        self.first_trip = FirstTrip(job.device, job.latch)
        self.alarm = Alarm(job.device.name)
        self.signal: str | None = None
        self.started = self._told = time.monotonic()

    def note_signal(self, number: int, _frame: object) -> None:
        """Note a signal that asks for zero; the next check acts on it."""
        self.signal = signal.Signals(number).name

    def tell(self) -> None:
        """Give the recorder a sign of life, if it is time for one."""
        if time.monotonic() - self._told > BEAT:
            self._told = time.monotonic()
            self.wire.post("beat")

    def wait_for_locks(self) -> None:
        """Give a sign of life, and raise the alarm where it takes long, without the locks.

        Raises
        ------
        InputError
            Where a signal has asked to end.
        """
        self.tell()
        device = self.job.device
        if self.signal is not None:
            raise InputError(
                f"the guardian was sent {self.signal} while it waited for its lock",
                remedy=f"See what drives: `{typed('status', device)}`.",
            )
        if time.monotonic() - self.started > self.job.settings.reconnect_time and self.job.replaces:
            self.raise_alarm(
                InputError(
                    "another program has the lock of the output",
                    remedy=f"End it, or see `{typed('status', device)}`",
                )
            )

    def raise_alarm(self, error: Exception) -> None:
        """Raise the alarm, for the reason why the output could not be shown to be at zero."""
        watchdog = "watchdog_time" in self.job.device
        text = f"the output could not be shown to be at zero ({error}). " + (
            "The device's watchdog takes it to zero."
            if watchdog
            else "The device has no watchdog: switch the amplifier off."
        )
        self.sound(text)

    def sound(self, text: str) -> None:
        """Raise the alarm with this text, at most as often as :class:`Alarm` does."""
        if self.alarm(text):
            self.wire.post("alarm", text)
