"""What the device does with time: plays its FIFO, measures, keeps watch, and ramps to zero."""

from collections import deque
from enum import IntEnum
from typing import Protocol

import numpy as np

from dea.bench.ring import Origin, Ring


class State(IntEnum):
    """What the device is doing."""

    IDLE = 0
    RAMPING = 1
    RUNNING = 2
    TRIPPED = 3


class Plant(Protocol):
    """What the device drives and measures; :class:`dea.plant.Rig` is one."""

    def advance(self, output_counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Apply these counts, a sample each; return the applied and the displacement counts."""


class Player:
    """Output FIFO, measurement ring and watchdog around a plant.

    Parameters
    ----------
    plant
        What is driven, a sample per output count.
    low, high
        Output counts that are never exceeded, whatever is asked.
    zero
        Output counts of 0 V.
    ramp_step
        Largest change of the output in one sample while the device itself ramps, counts.
    fifo_length, ring_length
        Samples the device holds ahead of and behind the clock.
    watchdog_time
        Silence of the owner, s, after which a driven output is taken to zero.
    """

    def __init__(
        self,
        plant: Plant,
        *,
        low: int,
        high: int,
        zero: int,
        ramp_step: int,
        fifo_length: int = 512,
        ring_length: int = 8192,
        watchdog_time: float = 1.0,
    ) -> None:
        self.plant, self.low, self.high, self.zero = plant, low, high, zero
        self.ramp_step, self.watchdog_time = ramp_step, watchdog_time
        self.fifo_length, self.ring = fifo_length, Ring(ring_length)
        self.state = State.IDLE
        self.latched = False
        self.trips = self.underruns = self.overruns = self.clamped = self.refused = 0
        self.position = 0  # samples of the FIFO played since it was cleared
        self.sequence = 0  # last block accepted
        self.collected = 0  # device index up to which the owner has read
        self.requested = zero  # held while nothing else is asked
        self.applied = zero
        self.displacement = 0
        self.last_heard = 0.0
        self._polled = False
        self._fifo: deque[int] = deque()

    @property
    def fifo_level(self) -> int:
        """Samples waiting to be played."""
        return len(self._fifo)

    @property
    def driven(self) -> bool:
        """Whether the output is away from zero, or about to be."""
        return self.applied != self.zero or self.requested != self.zero or bool(self._fifo)

    def load(self, sequence: int, counts: list[int]) -> bool:
        """Append a block to the FIFO once; return whether it stands there.

        A repeated sequence number is recognised and not appended again; a block out of sequence
        or too long for the FIFO is left to the host to send again.
        """
        if sequence == self.sequence:
            return True
        fits = len(self._fifo) + len(counts) <= self.fifo_length
        in_turn = sequence == self.sequence + 1 and self.state in (State.IDLE, State.RUNNING)
        if not (fits and in_turn):
            self.refused += 1
            return False
        self._fifo.extend(counts)
        self._polled = False
        self.sequence = sequence
        return True

    def clear(self) -> None:
        """Empty the FIFO and begin a new numbering of blocks and positions."""
        self._fifo.clear()
        self.sequence = self.position = 0

    def start(self) -> bool:
        """Begin to play; refused while the output is not zero or the watchdog has latched."""
        if self.state == State.RUNNING:
            return True
        if self.state != State.IDLE or self.latched or self.applied != self.zero:
            return False
        self.state, self.requested, self._polled = State.RUNNING, self.zero, False
        return True

    def stop(self) -> None:
        """Drop what waits and ramp to zero."""
        self._fifo.clear()
        if self.state == State.RUNNING:
            self.state = State.RAMPING

    def reset(self) -> bool:
        """Clear the latch; refused while the output is not zero."""
        if self.applied != self.zero:
            return False
        self.latched, self.state = False, State.IDLE
        return True

    def hold(self, count: int) -> bool:
        """Ask for one output value until the next; return whether the device is running."""
        if self.state != State.RUNNING:
            return False
        self.requested, self._polled = count, True
        return True

    def heard(self, now: float) -> None:
        """Note a word of the owner at ``now``, s."""
        self.last_heard = now

    def watch(self, now: float) -> None:
        """Take the output to zero, latch and count where the owner has been silent too long."""
        if self.state == State.TRIPPED or now - self.last_heard <= self.watchdog_time:
            return
        if self.driven or self.state != State.IDLE:
            self._fifo.clear()
            self.requested, self.state, self.latched = self.zero, State.TRIPPED, True
            self.trips += 1
            self.advance(1)

    def advance(self, count: int) -> None:
        """Let ``count`` samples pass."""
        while count > 0:
            wanted, origin, position = self._next(count)
            self._apply(np.asarray(wanted, np.int64), origin, position)
            count -= len(wanted)

    def drain(self) -> None:
        """Let as many samples pass as the FIFO or the ramp holds: the virtual clock."""
        while self.state == State.RAMPING or (self.state == State.RUNNING and self._fifo):
            self.advance(1 if self.state == State.RAMPING else len(self._fifo))

    def _next(self, count: int) -> tuple[list[int], Origin, int]:
        """What to apply now: at most ``count`` values of one origin."""
        if self.state == State.RAMPING:
            gap = self.zero - self.applied
            if not gap:
                self.state, self.requested = State.IDLE, self.zero
                return [self.zero], Origin.REST, self.position
            step = min(abs(gap), self.ramp_step)
            self.requested = self.applied + (step if gap > 0 else -step)
            return [self.requested], Origin.RAMP, self.position
        if self.state == State.RUNNING and self._fifo:
            played = [self._fifo.popleft() for _ in range(min(count, len(self._fifo)))]
            self.requested, position = played[-1], self.position
            self.position += len(played)
            return played, Origin.PLAYED, position
        if self.state == State.TRIPPED:
            return [self.zero] * count, Origin.TRIPPED, self.position
        if self._polled and self.state == State.RUNNING:
            return [self.requested] * count, Origin.POLLED, self.position
        if self.requested == self.zero:
            return [self.zero] * count, Origin.REST, self.position
        self.underruns += count
        return [self.requested] * count, Origin.HELD, self.position

    def _apply(self, wanted: np.ndarray, origin: Origin, position: int) -> None:
        inside = np.clip(wanted, self.low, self.high)
        self.clamped += int(np.count_nonzero(inside != wanted))
        applied, displacement = self.plant.advance(inside.astype(np.uint16))
        self.ring.append(applied, displacement, origin, position)
        self.applied, self.displacement = int(applied[-1]), int(displacement[-1])
        if self.state == State.RUNNING:
            oldest = self.ring.end - self.ring.length
            self.overruns += max(0, oldest - max(self.collected, oldest - inside.size))
