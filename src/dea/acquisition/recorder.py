"""The recorder's side of a guardian: what it measured, what is kept, and whether zero was shown."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import TracebackType
from typing import Any, Self

from dea.acquisition.alarm import Alarm
from dea.acquisition.command_line import typed
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.guardian import fork_server
from dea.acquisition.launch import launch
from dea.acquisition.link_log import LinkLog
from dea.acquisition.output import TakenError
from dea.acquisition.process import Process
from dea.acquisition.samples import DrivenSamples
from dea.acquisition.wire import unpacked
from dea.acquisition.zero import ZeroNotVerifiedError
from dea.errors import DeviceError

BEAT = 0.05  # s between two messages that say what is kept
GUARDIANS = 8  # that may end before zero is shown, one after the other
PAUSE = 0.2  # s longer before each of them
# s until a guardian reports, whatever has to be loaded for it: the first, before there is voltage,
# and those that follow it.
START_TIMEOUT, RESTART_TIMEOUT = 60.0, 20.0
# Guardians that give no sign of life and are killed; then the alarm, and the last is left to try.
MOST_KILLS = 2
LONGEST_LOOK = 0.5  # s of silence between two looks: more is time in which this process stood still


class GuardianLostError(DeviceError):
    """The guardian's process has ended, or does nothing, before it had shown zero."""


class Recorder:
    """Follows one guardian; a context manager that ends with the output shown at zero.

    Parameters
    ----------
    job
        What the guardian does.
    log
        Is given what the guardian's link logs.
    check
        Called between messages; may raise to end the drive.
    """

    def __init__(self, job: DriveJob, log: LinkLog, check: Callable[[], None]) -> None:
        self.job, self.log, self.check = job, log, check
        self.kept: Callable[[], int] = lambda: 0
        self.answer: Callable[[float], int] | None = None  # of a closed loop
        self.evidence = ""
        self._zero = False  # whether nothing is left to be taken to zero
        self._ending = False  # what ended the drive first is what the user is told
        self._beat = 0.0
        self._kills = 0
        self._inbox: deque[tuple[Any, ...]] = deque()  # a reader may stop in mid-batch
        self._start(self.job)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        try:
            self.end(error)
        finally:
            self.wire.close()
            if self._guardian is not None:
                self._guardian.close()
        if isinstance(error, DeviceError | OSError) and self.evidence:
            error.add_note(f"The output is at zero: {self.evidence}.")

    def await_ready(self) -> None:
        """Return when the guardian has taken the output; raises what made it refuse."""
        for kind, *_ in self._messages():
            if kind == "ready":
                return

    def samples(self) -> Iterator[DrivenSamples]:
        """Begin, and yield what is measured until zero is shown; raises what broke the drive."""
        self._say("begin", 0)
        for kind, *content in self._messages():
            if kind == "samples":
                yield content[0]

    def await_zero(self) -> None:
        """Return when zero is shown."""
        for _ in self._messages():
            pass

    def end(
        self, error: BaseException | None, keep: Callable[[DrivenSamples], None] | None = None
    ) -> None:
        """Have the output taken to zero, and wait until it is shown.

        ``keep`` is given what was measured meanwhile.

        Raises
        ------
        ZeroNotVerifiedError
            Where the guardian has raised its alarm; it goes on trying.
        """
        self.check, self.answer, self._ending = lambda: None, None, True
        lost = 0
        if not self._zero:
            self._say("stop", str(error) or type(error).__name__)
        while not self._zero:
            try:
                for kind, *content in self._messages():
                    if kind == "samples" and keep is not None:
                        with suppress(OSError):  # of the disk: the way to zero comes first
                            keep(content[0])
            except GuardianLostError as error:
                lost += 1
                self._replace_guardian(lost, error)
            except ZeroNotVerifiedError:
                raise
            except DeviceError:  # a refusal, after which there is nothing to take to zero
                pass

    def _replace_guardian(self, lost: int, error: GuardianLostError) -> None:
        """Start another guardian, which only takes the output to zero, after so many were lost."""
        cause: Exception = error
        never_came = self._guardian is None
        if self._guardian is not None:
            self._guardian.close()
        if lost <= GUARDIANS:
            time.sleep(PAUSE * (lost - 1))
            try:
                nothing = self.job.counts[:0]
                self._start(self.job._replace(counts=nothing, replaces=True), anew=never_came)
                return
            except OSError as refused:
                cause = refused
        raise self._given_up(
            f"no guardian can take the output to zero ({cause}): switch the amplifier off"
        )

    def _given_up(self, text: str) -> ZeroNotVerifiedError:
        """Raise the alarm, which no guardian can; return what the caller is told."""
        self._zero = True
        alarm = Alarm(self.job.device.name)
        alarm(text)
        alarm.join(1.0)
        return ZeroNotVerifiedError(text)

    def _start(self, job: DriveJob, *, anew: bool = False) -> None:
        self._replacement = job.replaces
        self._guardian: Process | None = None
        self._killed = False
        self._silence, self._looked = 0.0, time.monotonic()
        self.wire = launch(fork_server, anew=anew)
        self.wire.post(job)

    def _say(self, *message: Any) -> None:
        self._beat = time.monotonic()
        self.wire.post(*message)

    def _messages(self) -> Iterator[tuple[Any, ...]]:
        """Yield messages until zero is shown; meanwhile say what is kept."""
        while not self._zero:
            self.check()
            self._watch()
            if not self._inbox:
                self._inbox.extend(self.wire.take())
            if self._inbox:
                message = self._inbox.popleft()
                self._heed(*message)
                yield message
            elif self.wire.closed:
                how = " gave no sign of life and" if self._killed else "'s process"
                raise GuardianLostError(f"the guardian{how} was killed")
            else:
                self.wire.wait(BEAT)
            if time.monotonic() - self._beat > BEAT:
                self._say("kept", self.kept())

    def _watch(self) -> None:
        """Kill a guardian that gives no sign of life, as one that was stopped; another follows it.

        Time in which this process did not look does not count: both may have stood still.
        """
        now = time.monotonic()
        self._silence += min(now - self._looked, LONGEST_LOOK)
        self._looked = now
        if self._guardian is None:
            if self._silence > (RESTART_TIMEOUT if self._replacement else START_TIMEOUT):
                self.wire.close()
                raise GuardianLostError("no guardian has begun")
        elif self._silence > self.job.settings.patience:
            if self._killed or self._kills == MOST_KILLS:
                raise self._given_up(
                    f"the guardian has given no sign of life for {self._silence:.0f} s: switch the "
                    "amplifier off"
                )
            self._killed, self._silence = True, 0.0
            self._kills += 1
            self._guardian.kill()

    def _heed(self, kind: str, *content: Any) -> None:
        self._silence = 0.0
        if kind == "started":
            with suppress(ProcessLookupError):  # it has ended already
                self._guardian = Process(content[0])
        if kind == "ask" and self.answer is not None:
            self.wire.post("count", self.answer(content[0]))
        if kind in ("samples", "broken", "zero"):
            self.log.add(content[1])
        if kind == "zero":
            self._zero, self.evidence = True, content[0]
        elif kind == "alarm":
            self._zero = True  # the guardian is left to it
            raise ZeroNotVerifiedError(
                f"{content[0]} A guardian goes on trying: see `{typed('status', self.job.device)}`."
            )
        elif kind == "refused":
            refusal = unpacked(content[0])
            if self._replacement and not isinstance(refusal, TakenError):
                raise GuardianLostError(f"a guardian could not take over: {refusal}")
            self._zero = True
            raise refusal
        elif kind == "broken" and not self._ending:
            raise unpacked(content[0])
