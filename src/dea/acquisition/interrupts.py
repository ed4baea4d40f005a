"""Signals that ask an acquisition to end, heard only where it can end well."""

import signal
from types import FrameType, TracebackType
from typing import Self

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupted(KeyboardInterrupt):
    """A signal asked the acquisition to end."""


class Interruption:
    """Notes SIGINT, SIGTERM and SIGHUP while inside, and raises only where it is asked.

    An exception out of a signal handler could come at any instruction, also on the way to zero
    volts. So :meth:`check` raises it, between exchanges and while waiting, and the way to zero
    never calls that. A signal that comes too late for a check is raised on leaving.
    """

    def __init__(self) -> None:
        self._noted: str | None = None
        self._before: dict[signal.Signals, object] = {}

    def check(self) -> None:
        """Raise :class:`Interrupted` where a signal has come."""
        if self._noted is not None:
            raise Interrupted(self._noted)

    def __enter__(self) -> Self:
        try:
            self._before = {number: signal.signal(number, self._note) for number in SIGNALS}
        except ValueError:
            # Not in the main thread, which alone receives signals.
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
