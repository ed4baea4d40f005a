"""Driving a device without a buffer, sample by sample at absolute deadlines."""

import time
from collections.abc import Iterator

import numpy as np

from dea.acquisition.laws import Laws
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import Echo
from dea.acquisition.retrying_link import LONGEST_SLEEP, DeviceRefusedError, LinkError
from dea.acquisition.samples import BrokenRecordError, Quality, Samples
from dea.errors import DeviceError
from dea.modbus import Register, Window, encode, to_physical

START = 1  # command
BLOCK_TIME = 0.2  # s of samples yielded, and synced to the disk, together
NEIGHBOURS = 32  # registers that one request spans at most
APART = 0.25  # periods between a reply and the next write at least
LONGEST_PAUSE, PERIODS = 1.0, 5  # s, or periods if that is longer, that a hold-up may last


class Poll:
    """One sample: write the output, read back what the device applied and measured."""

    def __init__(self, panel: Panel) -> None:
        self.panel, self.link, device = panel, panel.link, panel.device
        self._next: int | None = None
        self.output = device["output"]
        echo = "applied_output" if "applied_output" in device else "output"
        names = ["displacement", echo, "device_index"]
        self.echo = echo if _readable(device.registers[echo]) else None
        wanted = [device[n] for n in names if n in device and (n != echo or self.echo)]
        self.windows = _windows(wanted)
        self._wrap = 1 << 16 * device["device_index"].size if "device_index" in device else 0

    def learn(self) -> None:
        """Find out which registers the device answers together; applies no voltage."""
        self.windows = [part for window in self.windows for part in self._answered(window)]

    def _answered(self, window: Window) -> list[Window]:
        """Split a window where the device refuses the undescribed addresses in it."""
        if sum(register.size for register in window.registers) == window.size:
            return [window]
        try:
            self.link.read(window.address, window.size, window.table)
        except DeviceRefusedError:
            return [Window([register]) for register in window.registers]
        return [window]

    def __call__(self, count: int, number: int) -> tuple[int, float, float]:
        """Drive one ``count``; return device index, applied and displacement counts.

        Without a device index, the ``number`` of the sample is its index; without a read-back, the
        applied output is the requested one.
        """
        self.panel.last_output = count
        words, first = encode(self.output, count), self.windows[0]
        if self.panel.device.read_write_multiple and first.table == "holding":
            reply = self.link.read_write(
                first.address, first.size, self.output.address, words, retry=False
            )
        else:
            self.link.write(self.output.address, words, retry=False)
            reply = self.link.read(first.address, first.size, first.table)
        values = first.decode(reply)
        for window in self.windows[1:]:
            values |= window.decode(self.link.read(window.address, window.size, window.table))
        applied = values[self.echo] if self.echo else count
        self.link.log.samples[-1] = 1
        index = values.get("device_index", number)
        if self._wrap and self._next is not None:  # a short index begins again at zero
            half = self._wrap // 2
            index = self._next + (index - self._next + half) % self._wrap - half
        self._next = index + 1
        return index, applied, values["displacement"]


def drive(
    panel: Panel,
    counts: np.ndarray,
    laws: Laws,
    *,
    late_after: float,
    tolerance: float,
    paced: bool = True,
) -> Iterator[Samples]:
    """Drive ``counts`` one by one and yield what was measured, in blocks.

    Sample k is written at its deadline k/sampling_rate after the first; one written more than
    ``late_after`` s behind it is flagged. Nothing is ever made up for in a burst: a sample whose
    whole period has passed is left out and flagged, or, on a device that counts its samples and
    has not counted this one, comes later with all that follow. Without ``paced``, for a device
    whose clock waits for the host, each sample follows the last at once. Jitter is kept in the
    link's log. ``tolerance`` is that of :class:`~dea.acquisition.read_back.Echo`; ``laws`` are
    checked with every sample.

    Raises
    ------
    BrokenRecordError
        Where an exchange failed, the device's index says that samples were missed, or this process
        was held up for long.
    ReadBackError
        Where the read-back of the output is not what was asked for.
    TripError
        Where the safety model is broken.
    """
    if "command" in panel:
        panel.set("command", START)
    poll, rows = Poll(panel), _Rows()
    poll.learn()
    echo = Echo(panel, poll.echo, tolerance) if poll.echo else None
    schedule = _Schedule(panel, counts) if paced else None
    number, expected = 0, None
    try:
        while number < counts.size:
            lateness = schedule.wait(number) if schedule else 0.0
            if schedule and lateness > schedule.longest_pause:
                raise _broken(f"held up for {lateness:.1f} s", number, number, counts, 1)
            if schedule and (missed := schedule.missed(number, lateness)):
                rows.leave_out(number, counts[number : number + missed])
                number, expected = number + missed, number + missed
            count = int(counts[number])
            sent = schedule.approach(count) if schedule else count
            flag = Quality.LATE if lateness > late_after or sent != count else Quality.GOOD
            begun = time.monotonic() - panel.link.log.started
            try:
                index, applied, displacement = poll(sent, number)
            except (LinkError, DeviceRefusedError) as error:
                place = number if expected is None else expected
                reason = f"never driven or read ({error})"
                raise _broken(reason, number, place, counts, 1) from error
            if expected is not None and index != expected:
                missing = index - expected
                what = f"the device measured {missing} more" if missing > 0 else "nothing new"
                raise _broken(what, number, expected, counts, max(missing, 1))
            if schedule:
                schedule.written(sent)
            if panel.device.safety is not None:
                volts = float(to_physical(panel.device["output"], sent))
                laws.check(volts, volts)
            if echo and not echo(sent, applied):
                flag |= Quality.CLAMPED
            ended = time.monotonic() - panel.link.log.started
            rows.add(number, index, count, applied, displacement, flag, begun, ended)
            number, expected = number + 1, index + 1
            yield from rows.due()
    except DeviceError:
        yield from rows.all()
        raise
    yield from rows.all()


class _Schedule:
    """The deadlines of samples, and what becomes of those that pass."""

    def __init__(self, panel: Panel, counts: np.ndarray) -> None:
        self.link, self.period = panel.link, 1.0 / panel.device.sampling_rate
        self.total, self.counted = counts.size, "device_index" in panel
        self.longest_pause = max(LONGEST_PAUSE, PERIODS * self.period)
        self.longest_step = int(np.abs(np.diff(counts, prepend=0)).max())
        self.start = time.monotonic() + self.period
        self._last, self._done, self._behind = 0, self.start - self.period, False

    def wait(self, number: int) -> float:
        """Sleep until the deadline of a sample; return how many seconds late it is then.

        Not before a part of the period has passed since the last reply: its write may have been
        held up until then.
        """
        deadline = self.start + number * self.period
        begin = max(deadline, self._done + APART * self.period)
        while (early := begin - time.monotonic()) > 0:
            if early > LONGEST_SLEEP:
                self.link.rest(early - LONGEST_SLEEP / 2)
            else:
                time.sleep(early)
        lateness = time.monotonic() - deadline
        self.link.log.jitter.append(lateness)
        return lateness

    def approach(self, count: int) -> int:
        """Return what to write for ``count``: after samples were left out, it is approached.

        No step is larger than the largest of the whole sequence.
        """
        if self._behind:
            step = min(max(count - self._last, -self.longest_step), self.longest_step)
            self._behind = self._last + step != count
            return self._last + step
        return count

    def written(self, count: int) -> None:
        """Note what has been written, and answered now."""
        self._last, self._done = count, time.monotonic()

    def missed(self, number: int, lateness: float) -> int:
        """Return how many samples from ``number`` on are left out since their time has passed."""
        passed = int(lateness / self.period)
        if self.counted:
            self.start += passed * self.period
            return 0
        missed = min(passed, self.total - 1 - number)
        self._behind |= missed > 0
        return missed


class _Rows:
    """Samples until they are handed on together."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._handed_on = time.monotonic()

    def add(self, *row: float) -> None:
        """Add a sample, its columns in the order of :class:`Samples`."""
        self._rows.append(row)

    def leave_out(self, number: int, counts: np.ndarray) -> None:
        """Add samples that are not driven, from ``number`` on."""
        for place, count in enumerate(counts.tolist(), start=number):
            flag = Quality.LATE | Quality.LOST
            self.add(place, place, count, 0, 0, flag, np.nan, np.nan)

    def due(self) -> Iterator[Samples]:
        """Yield the samples if the last ones were yielded long enough ago."""
        if time.monotonic() - self._handed_on > BLOCK_TIME:
            yield from self.all()
            self._handed_on = time.monotonic()

    def all(self) -> Iterator[Samples]:
        """Yield the samples."""
        rows, self._rows = self._rows, []
        if rows:
            # Each column by itself: whole numbers stay whole.
            yield Samples(*(np.array(column) for column in zip(*rows, strict=True)))


def _broken(
    reason: str, number: int, device_index: int, counts: np.ndarray, missing: int
) -> BrokenRecordError:
    """Return the error for ``missing`` samples from sample ``number`` on as lost."""
    requested = np.repeat(counts[number], missing)
    lost = Samples.lost(number, device_index, requested)._replace(position=np.full(missing, number))
    return BrokenRecordError(reason, number, missing, lost)


def _readable(register: Register) -> bool:
    return register.access != "write"


def _windows(registers: list[Register]) -> list[Window]:
    """Group neighbouring registers of a table, the group of ``displacement`` first."""
    groups: list[list[Register]] = []
    for register in sorted(registers, key=lambda r: (r.table, r.address)):
        last = groups[-1] if groups else None
        near = last and last[-1].table == register.table
        if last and near and register.end - last[0].address <= NEIGHBOURS:
            last.append(register)
        else:
            groups.append([register])
    groups.sort(key=lambda group: all(r.name != "displacement" for r in group))
    return [Window(group) for group in groups]
