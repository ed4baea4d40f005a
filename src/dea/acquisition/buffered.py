"""Driving a device that plays blocks from a FIFO and keeps what it measured in a ring.

Each exchange carries the next block and asks for the samples from an index on. Both are
idempotent: the device plays a sequence number once, and an index always names the same sample.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dea.acquisition.link import DeviceRefusedError, LinkError
from dea.acquisition.panel import Panel
from dea.acquisition.samples import BrokenRecordError, Quality, Samples
from dea.modbus import Window

PLAYED, HELD, REST = 1, 2, 3  # reply_origin
STATE_TRIPPED = 3  # reply_state
START, CLEAR = 1, 4  # command


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
    """The block registers of a device: one call sends a block and fetches samples."""

    def __init__(self, panel: Panel) -> None:
        self.link, self.errors = panel.link, panel.link.log.errors
        self.ask = Window.of_block(panel.device, "block_")
        self.answer = Window.of_block(panel.device, "reply_")
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


def _reply(value: dict) -> Reply:
    pairs = np.asarray(value["reply_samples"], np.int64)[: 2 * value["reply_count"]]
    return Reply(
        value["reply_sequence"], value["reply_index"], value["reply_position"],
        value["reply_next"], value["reply_origin"], value["reply_state"], value["reply_fifo"],
        pairs[0::2], pairs[1::2],
    )  # fmt: skip


def play(panel: Panel, counts: np.ndarray) -> Iterator[Samples]:
    """Start the device, play ``counts`` and yield what it measured, in order and whole.

    Samples the device added by holding its output are yielded with the position of the sample
    held, flagged. Lost or undriven ones are yielded flagged, then :class:`BrokenRecordError`
    is raised.
    """
    exchange, rate = BlockExchange(panel), panel.device.sampling_rate
    room = panel.whole("fifo_length") - exchange.capacity
    patience = min(exchange.capacity / rate, panel.number("watchdog_time") / 4) / 2
    boot = panel.get("boot")
    panel.set("command", CLEAR)
    wanted = exchange(0, counts[:0], 0).next
    sequence = sent = done = 0
    started, moved = False, time.monotonic()
    refusal: DeviceRefusedError | None = None
    while done < counts.size:
        block = counts[sent : sent + exchange.capacity] if refusal is None else counts[:0]
        offer = sequence + 1 if block.size else 0
        try:
            reply = exchange(offer, block, wanted)
        except DeviceRefusedError as error:
            if not offer:
                raise
            # What was played until the refusal can still be read.
            refusal = error
            continue
        if reply.applied.size or (offer and reply.sequence == offer):
            moved = time.monotonic()
        elif time.monotonic() - moved > panel.link.settings.reconnect_time:
            yield Samples.lost(done, wanted, counts[done:])
            raise BrokenRecordError("the device stands still", done, counts.size - done)
        if offer and reply.sequence == offer:
            sequence, sent = offer, sent + block.size
        elif reply.sequence != sequence or reply.next < wanted:
            yield Samples.lost(done, wanted, counts[done:])
            again = " and has been restarted" if panel.get("boot") != boot else ""
            raise BrokenRecordError(f"the device lost its place{again}", done, counts.size - done)
        if not started and (reply.fifo + exchange.capacity > room or sent == counts.size):
            panel.set("command", START)
            started = True
            continue
        if reply.index < wanted:  # a new connection, which has not yet said what it wants
            continue
        if reply.index > wanted:
            missing = reply.index - wanted
            yield Samples.lost(done, wanted, counts[done : done + missing])
            raise BrokenRecordError("overwritten before they were read", done, missing)
        samples = _samples(reply, counts)
        wanted += reply.applied.size
        if samples is not None:
            yield samples
            done = int(samples.position[-1]) + 1
        if refusal is not None and not reply.applied.size and reply.state != STATE_TRIPPED:
            yield Samples.lost(done, wanted, counts[done:sent])
            raise BrokenRecordError(str(refusal), done, counts.size - done)
        undriven = samples is not None and reply.origin not in (PLAYED, HELD)
        if undriven or (reply.state == STATE_TRIPPED and not reply.applied.size):
            raise BrokenRecordError(
                "undriven, the device took its output to zero", done, counts.size - done
            )
        if reply.fifo >= room - exchange.capacity and reply.next - wanted < exchange.capacity:
            time.sleep(patience)


def _samples(reply: Reply, counts: np.ndarray) -> Samples | None:
    """The samples of a reply; None where it holds none that were driven."""
    n = reply.applied.size
    if not n or reply.origin == REST:
        return None
    steps = np.arange(n)
    played = reply.origin == PLAYED
    position = reply.position + steps if played else np.full(n, max(reply.position - 1, 0))
    flag = Quality.GOOD if played else Quality.HELD if reply.origin == HELD else Quality.UNDRIVEN
    return Samples(
        position, reply.index + steps, counts[position], reply.applied, reply.displacement,
        np.full(n, flag),
    )  # fmt: skip
