"""The guardian: the process that alone writes the voltage, and always ends it at zero.

It writes no record, display or progress. The recorder sends it the whole sequence, which it plays
at its own deadlines, and must confirm the samples that it has stored. Whatever ends the sequence
(its end, a recorder that dies, stalls or asks for it, a device that fails, a broken law), the
guardian takes the output to zero, tries until zero is shown or a person dismisses it, and raises an
alarm meanwhile.
"""

import math
import os
import signal
import socket
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace

from dea.acquisition import buffered, polled
from dea.acquisition.closed_loop import Asked, ControllerError
from dea.acquisition.command_line import typed
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.duty import Duty, Order, Phase
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.acquisition.latch import held, refuse_tripped
from dea.acquisition.launch import serve_forks
from dea.acquisition.laws import TripError
from dea.acquisition.output import NotArmedError, Output, TakenError
from dea.acquisition.read_back import ReadBackError
from dea.acquisition.retrying_link import (
    DeviceRefusedError,
    LinkError,
    StoppedError,
)
from dea.acquisition.samples import DrivenSamples
from dea.acquisition.shared_file import GLANCE, SharedLock
from dea.acquisition.standby import Standby
from dea.acquisition.voltage_plan import OutputPlan, Planned
from dea.acquisition.wire import Wire, packed
from dea.acquisition.zero import WayToZero, ZeroEvidence
from dea.errors import DeviceError, InputError
from dea.modbus import adjoining, to_physical

SERVICE = 5e-3  # s between two looks at the recorder
ZERO_RETRIES = 3  # of one request on the way to zero
COUNTERS = ("clamped", "underruns", "overruns", "refused_blocks")
ANSWER_TIME = 1.0  # s that a controller may take for one sample
WAITING = 0.05  # s between two signs of life before the recorder begins
RETRY = 0.1  # s between two attempts to reach zero
KEEPING = 1.0  # s between two looks at the files of its locks
# s for which one that only takes the output to zero waits for a guardian that ends; one that
# replaces another waits as long as it takes.
TAKING_OVER = 5.0
STOP_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
# They would by default end or stop the process.
IGNORED_SIGNALS = (
    signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF,
    signal.SIGPIPE, signal.SIGIO, signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU,
)  # fmt: skip


def fork_server(handle: int) -> None:
    """Serve a recorder with guardians; see :mod:`dea.acquisition.launch`."""
    serve_forks(socket.socket(fileno=handle), guard)


def guard(wire: Wire) -> None:
    """Do the job that comes over ``wire``, to its end at zero."""
    while not (messages := wire.take()):
        if wire.closed:
            return
        wire.wait(1.0)
    job: DriveJob = messages[0][0]
    standby = Standby(wire, job, messages[1:])
    for number in STOP_SIGNALS:
        signal.signal(number, standby.note_signal)
    for number in IGNORED_SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    wire.post("started", os.getpid())
    waits = math.inf if job.replaces else GLANCE if job.counts.size else TAKING_OVER
    patience, meanwhile = job.settings.patience, standby.wait_for_locks
    while True:
        try:
            with (
                endpoint_lock(job.device, waits, meanwhile) as lock,
                Duty(job.device, waits=waits, meanwhile=meanwhile, patience=patience) as duty,
            ):
                Guardian(standby, lock, duty).serve()
            break
        except InputError as error:
            wire.post("refused", packed(error))
            break
        except OSError:  # no memory or no handle is left for the files of the locks
            if not job.replaces:
                raise
            meanwhile()
            time.sleep(RETRY)
    _deliver(wire, job.settings.stall_time)


def _deliver(wire: Wire, seconds: float) -> None:
    """Let the recorder take the last messages."""
    end = time.monotonic() + seconds
    while wire.unsent and not wire.closed and time.monotonic() < end:
        wire.wait(0.1)
        wire.take()
    wire.close()


class Guardian:
    """One job, with the locks of its output.

    :meth:`_check` says when it ends a drive for other reasons than the device's.

    Parameters
    ----------
    standby
        What it had before it had the locks.
    lock, duty
        That of the endpoint and that of the output, both taken.
    """

    def __init__(self, standby: Standby, lock: SharedLock, duty: Duty) -> None:
        self._standby, self.lock, self.duty = standby, lock, duty
        self.wire, self.job, self.link = standby.wire, standby.job, standby.link
        self.device = self.job.device
        self._early = standby.early
        self._begun = False
        # By the monotonic clock; what the locks were waited for counts, too.
        self._looked = self._heard = self._locked = standby.started
        self._posted: deque[tuple[int, float]] = deque()  # samples in all, time
        self._kept = 0
        self._answers: deque[int] = deque()
        self._first_trip = standby.first_trip
        # Another guardian may have claimed the device while this one waited.
        duty.token = (duty.token if self.job.replaces else 0) or self.job.token or duty.token
        self.output = Output(self.link, reset=self.job.reset, token=duty.token or 1)

    def serve(self) -> None:
        """Drive the job's counts, then take the output to zero."""
        self.link.check = self._alive
        if not self.job.counts.size:
            self.duty.clear_order()
            if (trip := held(self.device)) is not None:  # of a guardian that ended too early
                self._first_trip.latch(TripError(trip["reason"]), trip["time"])
            self._end_at_zero(self._last_known())
            return
        self._refuse_after_a_crash()
        self.duty.clear_order()
        try:
            # The guardian before may have kept one since the recorder looked.
            refuse_tripped(self.device)
            self.output.take()
        except Exception as error:
            self._refuse(error)
            return
        try:
            self._drive()
        except NotArmedError as error:
            self._refuse(error)
            return
        except Exception as error:
            self._break_off(error)
        self._end_at_zero(self._requested())

    def _refuse(self, error: Exception) -> None:
        """Tell of what has kept the drive from its start, which has asked for no voltage."""
        with suppress(Exception):
            self.link.close()
        self.duty.put(Phase.REFUSED, 0.0)
        self.wire.post("refused", packed(error))

    def _break_off(self, error: Exception) -> None:
        """Tell of what has ended the drive; whatever fails here keeps no output up."""
        log = self.link.log.cut()
        try:
            self.wire.post("broken", packed(error), log)
        except Exception:  # it cannot be sent as it is
            self.wire.post("broken", packed(DeviceError(str(error))), log)
        # A reply to an earlier request may still arrive on this connection.
        with suppress(Exception):
            self.link.close()
        self.output.trusted = not isinstance(error, ReadBackError)
        # A read-back that has been found wrong is a trip where there is a safety model.
        laws = (TripError, ReadBackError) if self.device.safety else TripError
        self._first_trip.latch(error if isinstance(error, laws) else None)

    def _last_known(self) -> float | None:
        """Return what the guardian before asked for last, V, or None where nobody knows.

        Where the last guardian has shown zero, a reading is no reason to write anything else.
        """
        before = self.duty.before
        if before.abandoned:
            return self.duty.left
        return 0.0 if before.phase in (Phase.AT_ZERO, Phase.UNKEPT) else None

    def _refuse_after_a_crash(self) -> None:
        if self.duty.before.abandoned and not self.device.virtual:
            raise InputError(
                "an earlier guardian ended without taking the output to zero: it had asked for "
                f"{self.duty.before.requested:g} V",
                file=self.device.source,
                remedy=f"Take it to zero: {typed('zero', self.device)}.",
            )

    def _drive(self) -> None:
        self.link.check = self._check
        # The high voltage may be on from here, whether or not the device answers or this is killed.
        self.duty.put(Phase.DRIVING, 0.0)
        self.output.arm()
        self.wire.post("ready")
        while not self._begun:
            self.wire.wait(WAITING)
            self._check()
            if "state" in self.device:  # a silent owner loses the outputs
                self.output.panel.get("state")
        total, before = 0, self._counters()
        for samples in self._driven():
            total += samples.position.size
            self._posted.append((total, time.monotonic()))
            self.wire.post("samples", samples, self.link.log.cut())
            self._check()
        for name, count in self._counters().items():
            if count != before.get(name, count):
                self.link.log.errors[name] += count - before[name]

    def _counters(self) -> dict[str, int]:
        """Return what the device counts against the record, by the registers' names, if it says."""
        counts: dict[str, int] = {}
        with suppress(LinkError, DeviceRefusedError):
            for window in adjoining(self.device[n] for n in COUNTERS if n in self.device):
                words = self.link.read(window.address, window.size, window.table)
                counts |= window.decode(words)
        return counts

    def _driven(self) -> Iterator[DrivenSamples]:
        settings, counts = self.job.settings, self.job.counts
        if settings.mode == "polled":
            return polled.drive(
                self.output.panel, self._sequence(), self.output.laws,
                late_after=settings.late_after, tolerance=settings.read_back_tolerance,
                paced=settings.paced,
            )  # fmt: skip
        return buffered.play(
            self.output.panel, counts, self.output.laws, tolerance=settings.read_back_tolerance
        )

    def _sequence(self) -> polled.DrivenCounts:
        job = self.job
        if not job.closed_loop_samples:
            return Planned(job.counts, self.output.panel.zero)
        plan = OutputPlan(job.counts, job.counts.size, job.closed_loop_samples)
        return Asked(self.device, plan, job.longest_step, self._ask, self._answer)

    def _ask(self, displacement: float) -> None:
        """Ask the recorder for the next count."""
        self.wire.post("ask", displacement)

    def _answer(self) -> int:
        """Wait for the count that was asked for.

        A device that is not paced has a clock that waits for the host, so that this has no time
        limit of its own there: the record would depend on the load of the host. A recorder that
        stalls ends the wait.
        """
        end = time.monotonic() + ANSWER_TIME if self.job.settings.paced else math.inf
        while not self._answers:
            if time.monotonic() > end:
                raise ControllerError(f"the controller gave no voltage for {ANSWER_TIME:g} s")
            self.wire.wait(SERVICE)
            self._listen()
            self._check()
        return self._answers.popleft()

    def _listen(self) -> None:
        """Take what the recorder has said."""
        messages, self._early = self._early + self.wire.take(), []
        for kind, content in messages:
            if kind == "stop":
                raise StoppedError(f"ended by the recorder: {content}")
            if kind == "count":
                self._answers.append(content)
                continue
            self._begun |= kind == "begin"
            self._heard, self._kept = time.monotonic(), content

    def _check(self) -> None:
        """Note the voltage asked for, and end the drive where the recorder does not keep up."""
        now = time.monotonic()
        if now - self._looked < SERVICE:
            return
        self._looked = now
        self.duty.put(Phase.DRIVING, self._requested())
        self._standby.tell()
        self._listen()
        if not self._keep_locks():
            raise StoppedError("another program has taken the output over")
        if self.wire.closed:
            raise StoppedError("the recorder has died")
        if (sent := self._standby.signal) is not None:
            raise StoppedError(f"the guardian was sent {sent}")
        if self.duty.order != Order.NONE:
            raise StoppedError("somebody asked for zero")
        while self._posted and self._posted[0][0] <= self._kept:
            self._posted.popleft()
        oldest = min(self._heard, self._posted[0][1]) if self._posted else self._heard
        if now - oldest > self.job.settings.stall_time:
            raise StoppedError(f"the recorder is {now - oldest:.1f} s behind: it, or its disk")

    def _alive(self) -> None:
        """Give a sign of life, to the recorder and to whoever looks at the notice."""
        self.duty.beat()
        self._standby.tell()
        self._keep_locks()

    def _keep_locks(self) -> bool:
        """Return whether the output is this guardian's, whoever removes the files that say so."""
        if time.monotonic() - self._locked < KEEPING:
            return True
        kept = self.lock.keep() and self.duty.keep()
        self._locked = time.monotonic()
        return kept

    def _requested(self) -> float:
        """Return the voltage asked for last."""
        last = self.output.panel.last_output
        return 0.0 if last is None else float(to_physical(self.device["output"], last))

    def _end_at_zero(self, requested: float | None) -> None:
        """Take the output to zero, whatever fails and however long it takes."""
        # Each attempt is short: what repeats them is the loop below.
        retries = min(self.job.settings.retries, ZERO_RETRIES)
        self.link.settings = replace(self.job.settings, retries=retries, reconnect_time=0.0)
        self.link.longest_repetition = math.inf
        self.link.on_connect = self.output.reclaim
        way = WayToZero(self.output, ramp_rate=self.job.settings.ramp_rate, requested=requested)
        failing: float | None = None

        def alive() -> None:
            self._first_trip.latch(way.trip)
            # A guardian that follows this one is not to take a voltage for known that is not.
            arriving = Phase.TO_ZERO if way.known else Phase.CHECKING
            self.duty.put(Phase.ALARM if failing else arriving, way.volts)
            self._alive()

        self.link.check = alive
        while True:
            try:
                alive()
                evidence = way()
                break
            except TakenError as error:
                if not self.job.counts.size:
                    if not self.duty.before.abandoned:
                        self.duty.put(Phase.REFUSED, 0.0)
                    self.wire.post("refused", packed(error))
                    return
                evidence = ZeroEvidence.RELEASED
                break
            except Exception as error:  # only zero, or a person's order to dismiss, ends this loop
                failing = failing or time.monotonic()
                self._first_trip.latch(way.trip)
                if time.monotonic() - failing >= self.job.settings.reconnect_time:
                    with suppress(Exception):
                        self._standby.raise_alarm(error)
                        self.link.log.cut()  # nobody waits for it, and this may last for days
                    with suppress(Exception):  # which is what is left to do
                        self.output.laws.disarm()
                    if self.duty.order == Order.DISMISS or self.device.virtual:
                        self._await_latch(alive)
                        self.duty.put(Phase.DISMISSED, way.volts)
                        return
            time.sleep(RETRY)
        self._first_trip.latch(way.trip)
        self._await_latch(self._alive_at_zero)
        self.link.check = None
        self.duty.put(Phase.AT_ZERO, 0.0)
        self.link.on_connect = None
        self.link.close()
        self.wire.post("zero", str(evidence), self.link.log.cut())

    def _alive_at_zero(self) -> None:
        self.duty.put(Phase.UNKEPT, 0.0)
        self._alive()

    def _await_latch(self, alive: Callable[[], None]) -> None:
        """Wait until a trip is kept, and call ``alive`` meanwhile; a person may end it."""
        begun = time.monotonic()
        while (trip := self._first_trip.pending) is not None:
            with suppress(Exception):
                alive()
            self._first_trip.latch()
            time.sleep(RETRY)
            if time.monotonic() - begun > self.job.settings.reconnect_time:
                why = self._first_trip.failure or "it hangs"
                self._standby.sound(
                    f"a trip ({trip}) is not kept yet: the disk does not take it ({why})."
                )
                if self.duty.order == Order.DISMISS:
                    return
