"""Driving a device without a buffer, sample by sample at absolute deadlines."""

import time
from collections.abc import Iterator

import numpy as np

from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.acquisition.samples import BrokenRecordError, Quality, Samples
from dea.modbus import Register, Window, encode

START = 1  # command
BLOCK_TIME = 0.2  # s of samples yielded, and synced to the disk, together
NEIGHBOURS = 32  # registers that one request spans at most


class Poll:
    """One sample: write the output, read back what the device applied and measured."""

    def __init__(self, panel: Panel) -> None:
        self.panel, self.link, device = panel, panel.link, panel.device
        self.output = device["output"]
        echo = "applied_output" if "applied_output" in device else "output"
        names = ["displacement", echo, "device_index"]
        self.echo = echo if _readable(device.registers[echo]) else None
        wanted = [device[n] for n in names if n in device and (n != echo or self.echo)]
        self.windows = _windows(wanted)

    def __call__(self, count: int, number: int) -> tuple[int, int, int]:
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
        return values.get("device_index", number), applied, values["displacement"]


def drive(
    panel: Panel, counts: np.ndarray, *, late_after: float, paced: bool = True
) -> Iterator[Samples]:
    """Drive ``counts`` one by one and yield what was measured, in blocks.

    Sample k is written at its deadline k/sampling_rate after the first; one written more than
    ``late_after`` s behind it is flagged. Without ``paced``, for a device whose clock waits for the
    host, each sample follows the last at once. Jitter is kept in the link's log.

    Raises
    ------
    BrokenRecordError
        Where an exchange failed, or the device's index says that samples were missed.
    """
    if "command" in panel:
        panel.set("command", START)
    poll, period = Poll(panel), 1.0 / panel.device.sampling_rate
    rows: list[tuple[int, int, int, int, int, int]] = []
    started = time.monotonic() + (period if paced else 0.0)
    handed_on, expected = started, None
    for number, count in enumerate(counts.tolist()):
        lateness = _wait(started + number * period) if paced else 0.0
        if paced:
            panel.link.log.jitter.append(lateness)
        try:
            index, applied, displacement = poll(count, number)
        except (LinkError, DeviceRefusedError) as error:
            yield from _block(rows)
            place = number if expected is None else expected
            raise _broken(f"never driven or read ({error})", number, place, counts, 1) from error
        if expected is not None and index != expected:
            yield from _block(rows)
            missing = index - expected
            what = f"the device measured {missing} more" if missing > 0 else "nothing new measured"
            raise _broken(what, number, expected, counts, max(missing, 1))
        expected = index + 1
        flag = Quality.LATE if lateness > late_after else Quality.GOOD
        rows.append((number, index, count, applied, displacement, flag))
        if time.monotonic() - handed_on > BLOCK_TIME:
            yield from _block(rows)
            rows, handed_on = [], time.monotonic()
    yield from _block(rows)


def _wait(deadline: float) -> float:
    """Sleep until ``deadline``; return how many seconds late it is then."""
    while (early := deadline - time.monotonic()) > 0:
        time.sleep(early)
    return -early


def _broken(
    reason: str, number: int, device_index: int, counts: np.ndarray, missing: int
) -> BrokenRecordError:
    """Return the error for ``missing`` samples from sample ``number`` on as lost."""
    requested = np.repeat(counts[number], missing)
    lost = Samples.lost(number, device_index, requested)._replace(position=np.full(missing, number))
    return BrokenRecordError(reason, number, missing, lost)


def _block(rows: list[tuple[int, int, int, int, int, int]]) -> Iterator[Samples]:
    if rows:
        yield Samples(*np.array(rows, np.int64).T)


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
