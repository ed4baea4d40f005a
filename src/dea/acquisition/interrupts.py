"""Signals that end an acquisition, handled only at points where it can end safely."""

import signal
from types import FrameType, TracebackType
from typing import Self

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(KeyboardInterrupt):
    """A signal asked the acquisition to end."""


class Interruption:
    """Notes SIGINT, SIGTERM and SIGHUP while entered, and raises on request only.

    SIGHUP stays ignored where it is: the program was started with ``nohup``.

    An exception from a signal handler could interrupt any instruction, also of the ramp to zero
    volts. Therefore :meth:`check` raises it, between exchanges and while waiting, and the ramp to
    zero does not call :meth:`check`. A signal after the last check is raised on leaving.
    """

    def __init__(self) -> None:
        self._noted: str | None = None
        self._before: dict[signal.Signals, object] = {}

    def check(self) -> None:
        """Raise :class:`Interrupted` if a signal has been noted."""
        if self._noted is not None:
            raise Interrupted(self._noted)

    def __enter__(self) -> Self:
        try:
            self._before = {
                number: signal.signal(number, self._note)
                for number in SIGNALS
                if (number, signal.getsignal(number)) != (signal.SIGHUP, signal.SIG_IGN)
            }
        except ValueError:
            # Signal handlers can be set in the main thread only.
            self._before = {}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]
        if kind is None:
            self.check()

    def _note(self, number: int, _frame: FrameType | None) -> None:
        self._noted = self._noted or signal.Signals(number).name
