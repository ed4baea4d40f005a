"""Driving a device without a buffer, sample by sample at absolute deadlines."""

import time
from collections.abc import Iterator
from typing import Protocol

import numpy as np

from dea.acquisition.laws import Laws
from dea.acquisition.panel import Panel
from dea.acquisition.poll import Poll
from dea.acquisition.read_back import Echo
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.acquisition.rows import Rows
from dea.acquisition.samples import BrokenRecordError, DrivenSamples, Quality
from dea.acquisition.schedule import Schedule
from dea.errors import DeviceError
from dea.modbus import Command, to_physical


class DrivenCounts(Protocol):
    """The counts to be driven: all known beforehand, or asked for one by one."""

    size: int
    longest_step: int

    def count(self, number: int) -> int:
        """Return the count of a sample, after all samples before it were measured."""
        ...

    def measured(self, number: int, displacement: float) -> None:
        """Note the raw displacement of a sample."""
        ...


def drive(
    panel: Panel,
    sequence: DrivenCounts,
    laws: Laws,
    *,
    late_after: float,
    tolerance: float,
    paced: bool = True,
) -> Iterator[DrivenSamples]:
    """Drive a sequence one by one and yield what was measured, in blocks.

    Sample k is written at its deadline k/sampling_rate after the first; one written more than
    ``late_after`` s behind it is flagged. Late samples are never sent in a burst: one whose
    whole period has passed is left out and flagged, or, on a device that counts its samples, comes
    later with all that follow; what such a device measured meanwhile, its output held, is flagged
    as held and lost. No reading is repeated for longer than a hold-up may last: the output would
    be held meanwhile. Without ``paced``, for a device whose clock waits for the host, each sample
    follows the last at once. Jitter is kept in the link's log. ``tolerance`` is that of
    :class:`~dea.acquisition.read_back.Echo`; ``laws`` are checked with every sample.

    Raises
    ------
    BrokenRecordError
        Where an exchange failed, or this process was held up for long, as the device's index or the
        clock says.
    ReadBackError
        Where the read-back of the output is not what was asked for.
    TripError
        Where the safety model is broken.
    """
    if "command" in panel:
        panel.set("command", Command.START)
    poll, rows = Poll(panel), Rows()
    poll.learn()
    echo = Echo(panel, poll.echo.name, tolerance) if poll.echo else None
    schedule = Schedule(panel, sequence.size, sequence.longest_step) if paced else None
    if schedule:
        panel.link.longest_repetition = schedule.longest_pause
    number, expected, last = 0, None, panel.zero
    try:
        while number < sequence.size:
            count, lateness = sequence.count(number), 0.0
            if schedule:
                lateness = schedule.wait(number)
                if missed := _missed(schedule, sequence, number, lateness):
                    rows.leave_out(number, missed)
                    number = expected = number + len(missed)
                    count = sequence.count(number)
            sent = schedule.approach(count) if schedule else count
            flag = Quality.LATE if lateness > late_after or sent != count else Quality.GOOD
            begun = time.monotonic() - panel.link.log.started
            try:
                index, applied, displacement = poll(sent, number)
            except (LinkError, DeviceRefusedError) as error:
                place = number if expected is None else expected
                reason = f"never driven or read ({error})"
                raise _broken(reason, number, place, count, 1) from error
            if expected is not None and index != expected:
                _refuse_jump(schedule, index - expected, number, expected, count)
                rows.hold(number - 1, range(expected, index), last)
            ended = time.monotonic() - panel.link.log.started
            if schedule:
                # An exchange that was held up was carried out at some time until its reply. Where
                # the device counts its samples, it says itself which one that was.
                late = lateness + ended - begun > max(schedule.period, late_after)
                if late and not schedule.counted:
                    flag |= Quality.LATE
                schedule.written(sent)
            if echo and not echo.right(sent, applied):
                flag |= Quality.CLAMPED
            # Before what may end the drive: the sample that ends it is of the record, too.
            rows.add(number, index, count, applied, displacement, flag, begun, ended)
            if panel.device.safety is not None:
                volts = float(to_physical(panel.device["output"], sent))
                laws.check(volts, volts)
            if echo:
                echo(sent, applied)
            sequence.measured(number, displacement)
            number, expected, last = number + 1, index + 1, count
            yield from rows.due()
    except DeviceError:
        yield from rows.all()
        raise
    yield from rows.all()


def _missed(schedule: Schedule, sequence: DrivenCounts, number: int, lateness: float) -> list[int]:
    """Return the counts from sample ``number`` on that are left out: their time has passed.

    Raises
    ------
    BrokenRecordError
        Where this process was held up for too long.
    """
    if lateness > schedule.longest_pause:
        held = f"held up for {lateness:.1f} s"
        raise _broken(held, number, number, sequence.count(number), 1)
    missed = schedule.missed(number, lateness)
    return [sequence.count(each) for each in range(number, number + missed)]


def _refuse_jump(
    schedule: Schedule | None, more: int, number: int, expected: int, count: int
) -> None:
    """Refuse a device's index that is ``more`` than ``expected`` with sample ``number``.

    Raises
    ------
    BrokenRecordError
        Where the device measured nothing, or by itself for longer than a hold-up may last.
    """
    # A quotient that is whole may come out below.
    most = int(schedule.longest_pause / schedule.period + 1e-9) if schedule else 0
    if not 0 < more <= most:
        what = f"the device measured {more} more" if more > 0 else "nothing new"
        raise _broken(what, number, expected, count, max(1, min(more, most)))


def _broken(
    reason: str, number: int, device_index: int, count: int, missing: int
) -> BrokenRecordError:
    """Return the error for ``missing`` samples from sample ``number`` on as lost."""
    requested = np.repeat(count, missing)
    lost = DrivenSamples.lost(number, device_index, requested)._replace(
        position=np.full(missing, number)
    )
    return BrokenRecordError(reason, number, missing, lost)
