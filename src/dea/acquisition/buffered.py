"""Driving a device that plays blocks from a FIFO and keeps what it measured in a ring.

Each exchange sends the next block and requests the samples from an index on. Both are idempotent:
the device plays a sequence number once, and an index always means the same sample.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dea.acquisition.laws import Laws
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import Echo, ReadBack, applied_register
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.acquisition.samples import BrokenRecordError, DrivenSamples, Quality
from dea.modbus import Command, DeviceState, Origin, block_window, reply_window, to_physical

UNDRIVEN = "undriven, the device took its output to zero"


@dataclass(frozen=True)
class Reply:
    """One answer of the block protocol."""

    sequence: int
    index: int
    position: int
    next: int
    origin: int
    state: int
    fifo: int
    applied: np.ndarray
    displacement: np.ndarray


class BlockExchange:
    """The block registers of a device: one call sends a block and reads samples."""

    def __init__(self, panel: Panel) -> None:
        self.link, self.errors = panel.link, panel.link.log.errors
        self.ask = block_window(panel.device)
        self.answer = reply_window(panel.device)
        self.capacity = panel.device["block_samples"].count

    def __call__(self, sequence: int, counts: np.ndarray, read_index: int) -> Reply:
        """Send block ``sequence`` (0 sends none) and read samples from ``read_index`` on."""
        padded = np.zeros(self.capacity, int)
        padded[: counts.size] = counts
        words = self.ask.encode(
            {
                "block_sequence": sequence,
                "block_read_index": read_index,
                "block_count": int(counts.size),
                "block_samples": padded.tolist(),
            }
        )
        for _ in range(self.link.settings.retries + 1):
            reply = self.link.read_write(
                self.answer.address, self.answer.size, self.ask.address, words
            )
            if self.answer.intact(reply):
                value = self.answer.decode(reply)
                self.link.log.samples[-1] = value["reply_count"]
                return _reply(value)
            self.errors["checksum"] += 1
        raise LinkError("no reply with a valid checksum")


def _reply(value: dict[str, Any]) -> Reply:
    pairs = np.asarray(value["reply_samples"], np.int64)[: 2 * value["reply_count"]]
    return Reply(
        value["reply_sequence"], value["reply_index"], value["reply_position"],
        value["reply_next"], value["reply_origin"], value["reply_state"], value["reply_fifo"],
        pairs[0::2], pairs[1::2],
    )  # fmt: skip


def play(
    panel: Panel, counts: np.ndarray, laws: Laws, *, tolerance: float
) -> Iterator[DrivenSamples]:
    """Start the device, play ``counts`` and yield what it measured, in order and complete.

    ``tolerance`` is that of :class:`~dea.acquisition.read_back.ReadBack`. Samples that the device
    added by holding its output are yielded with the position of the sample held, and flagged.
    ``laws`` are checked as often as they ask for.

    Raises
    ------
    BrokenRecordError
        Where samples are lost or not driven; it carries them, flagged.
    ReadBackError
        Where the register of the applied output does not hold what is played.
    TripError
        Where the safety model is broken.
    """
    applied = applied_register(panel.device)
    echo = Echo(panel, applied.name, tolerance)
    playback = _Playback(panel, counts, laws, echo)
    read_back = ReadBack(panel, counts, tolerance)
    while playback.done < counts.size:
        reply = playback.feed()
        if reply is not None:
            samples = playback.collect(reply)
            if samples is not None:
                yield samples
            read_back(playback.sent - reply.fifo)
            playback.supervise(reply)
            playback.rest(reply)


class _Playback:
    """The progress of a sequence of counts: sent to the device, and read back as samples."""

    def __init__(self, panel: Panel, counts: np.ndarray, laws: Laws, echo: Echo) -> None:
        self.panel, self.counts, self.exchange = panel, counts, BlockExchange(panel)
        self.laws, self._volts = laws, np.append(0.0, to_physical(panel.device["output"], counts))
        self._position, self.echo = 0, echo
        capacity, period = self.exchange.capacity, 1.0 / panel.device.sampling_rate
        fifo = panel.get("fifo_length")
        assert isinstance(fifo, int)  # its description is refused otherwise
        self.high_water = fifo - 2 * capacity
        self.pause = min(capacity * period, panel.number("watchdog_time") / 4) / 2
        self.boot = panel.get("boot")
        panel.set("command", Command.CLEAR)
        self.wanted = self.exchange(0, counts[:0], 0).next
        self.sequence = self.sent = self.done = 0
        self.started, self.moved = False, time.monotonic()
        self.refusal: DeviceRefusedError | None = None

    def feed(self) -> Reply | None:
        """Send the next block, if one is left; return None if the device refuses it."""
        block = self.counts[self.sent :][: self.exchange.capacity * (self.refusal is None)]
        offer = self.sequence + 1 if block.size else 0
        try:
            reply = self.exchange(offer, block, self.wanted)
        except DeviceRefusedError as error:
            if not offer:
                raise
            self.refusal = error  # the samples played so far can still be read
            return None
        except LinkError as error:
            raise self._broken(f"never driven or read ({error})") from error
        accepted = bool(offer) and reply.sequence == offer
        if reply.next < self.wanted or not (accepted or reply.sequence == self.sequence):
            raise self._misplaced()
        if accepted:
            self.sequence, self.sent = offer, self.sent + block.size
            self.panel.last_output = int(block[-1])
            self.moved = time.monotonic()
        return reply

    def collect(self, reply: Reply) -> DrivenSamples | None:
        """Return the samples of a reply that were driven, or None."""
        if reply.index < self.wanted:  # of a new connection, which has not sent its index yet
            return None
        if reply.index > self.wanted:
            raise self._broken("overwritten before they were read", reply.index - self.wanted)
        resting, empty = reply.origin == Origin.REST, not reply.applied.size
        if empty and reply.state == DeviceState.TRIPPED:
            raise self._broken(UNDRIVEN)
        if empty and self.refusal is not None:
            raise self._broken(str(self.refusal))
        if not (resting or empty):
            self.moved = time.monotonic()
        elif time.monotonic() - self.moved > self.panel.link.settings.reconnect_time:
            raise self._broken("the device stands still")
        if reply.origin == Origin.PLAYED and not empty and reply.position != self.done:
            raise self._misplaced()
        if resting and self.done and not empty:
            if reply.state != DeviceState.RUNNING:
                raise self._broken(UNDRIVEN)
            # The FIFO has run empty at zero volts, within the sequence.
            reply = replace(reply, origin=Origin.HELD)
        now = time.monotonic() - self.panel.link.log.started
        samples = _samples(reply, self.counts, self.echo, now)
        self.wanted += reply.applied.size
        if samples is None:
            return None
        if reply.origin not in (Origin.PLAYED, Origin.HELD):
            raise BrokenRecordError(UNDRIVEN, self.done, self.counts.size - self.done, samples)
        self.done = int(samples.position[-1]) + 1
        return samples

    def supervise(self, reply: Reply) -> None:
        """Check the laws where it is time, for the voltages between the last check and now."""
        if not self.laws.due():
            return
        position = self.sent - reply.fifo
        ahead = int(2 * self.pause * self.panel.device.sampling_rate) + 2
        played = self._volts[self._position : position + ahead]
        self.laws.check(float(played.min()), float(played.max()))
        self._position = position

    def rest(self, reply: Reply) -> None:
        """Start once the FIFO holds what it can; wait while it does and little is there to read."""
        full = reply.fifo >= self.high_water or self.sent == self.counts.size
        if not self.started and full:
            self.panel.set("command", Command.START)
            self.started = True
        elif full and reply.next - self.wanted < self.exchange.capacity:
            left = min(self.pause, reply.fifo / self.panel.device.sampling_rate)
            while left > 0:
                step = min(left, self.laws.interval)
                self.panel.link.rest(step)
                self.supervise(reply)
                left -= step

    def _misplaced(self) -> BrokenRecordError:
        again = " and has been restarted" if self.panel.get("boot") != self.boot else ""
        return self._broken(f"the device lost its place{again}")

    def _broken(self, reason: str, count: int | None = None) -> BrokenRecordError:
        """Return the error for the next ``count`` samples, or all that are left, as lost."""
        missing = self.counts[self.done :][:count]
        lost = DrivenSamples.lost(self.done, self.wanted, missing)
        return BrokenRecordError(reason, self.done, missing.size, lost)


def _samples(reply: Reply, counts: np.ndarray, echo: Echo, now: float) -> DrivenSamples | None:
    """Return the samples of a reply, or None if it holds none that were driven."""
    n = reply.applied.size
    if not n or reply.origin == Origin.REST:
        return None
    steps = np.arange(n)
    played = reply.origin == Origin.PLAYED
    position = reply.position + steps if played else np.full(n, max(reply.position - 1, 0))
    held = reply.origin == Origin.HELD
    flag = Quality.GOOD if played else Quality.HELD if held else Quality.UNDRIVEN
    flags = np.full(n, flag)
    if played:
        flags[~echo.right(counts[position], reply.applied)] |= Quality.CLAMPED
    return DrivenSamples(
        position, reply.index + steps, counts[position], reply.applied, reply.displacement,
        flags, np.full(n, np.nan), np.full(n, now),
    )  # fmt: skip
