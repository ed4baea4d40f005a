"""The device in time: it plays its FIFO, measures, runs its watchdog and ramps to zero."""

from collections import deque
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dea.bench.ring import Counts, Ring
from dea.bench.watchdog import Watchdog
from dea.modbus import DeviceState, Origin


class DrivenRig(Protocol):
    """What the device drives and measures; :class:`dea.plant.Rig` is one."""

    def advance(self, output_counts: Counts) -> tuple[Counts, Counts]:
        """Apply one count per sample; return the applied and the displacement counts.

        All have the shape (samples,).
        """
        ...


@dataclass(frozen=True)
class OutputLimits:
    """Counts of the output: ``zero`` of 0 V, and ``low`` and ``high``, which nothing exceeds.

    ``ramp_step`` is the largest change in one sample while the device itself ramps.
    """

    low: int
    high: int
    zero: int
    ramp_step: int


class Player:
    """Output FIFO, measurement ring and watchdog around a plant.

    Parameters
    ----------
    plant
        What is driven, one sample per output count.
    limits
        Of the output.
    fifo_length, ring_length
        Samples that the device holds before they are played and after they are measured.
    watchdog_time
        Silence of the owner, s, after which a driven output is taken to zero.
    """

    def __init__(
        self,
        plant: DrivenRig,
        limits: OutputLimits,
        *,
        fifo_length: int = 512,
        ring_length: int = 8192,
        watchdog_time: float = 1.0,
    ) -> None:
        self.plant, self.limits, self.watchdog = plant, limits, Watchdog(watchdog_time)
        self.fifo_length, self.ring = fifo_length, Ring(ring_length)
        self.state = DeviceState.IDLE
        self.underruns = self.overruns = self.clamped = self.refused = 0
        self.position = 0  # samples of the FIFO played since it was cleared
        self.sequence = 0  # of the last block accepted
        self.collected = 0  # device index up to which the owner has read
        self.requested = limits.zero  # the output until another one is asked for
        self.applied = limits.zero
        self.displacement = 0
        self._polled = False
        self._fifo: deque[int] = deque()

    @property
    def zero(self) -> int:
        """Output count of 0 V."""
        return self.limits.zero

    @property
    def fifo_level(self) -> int:
        """Samples waiting to be played."""
        return len(self._fifo)

    @property
    def driven(self) -> bool:
        """Whether the output is not zero, or will not be."""
        return self.applied != self.zero or self.requested != self.zero or bool(self._fifo)

    def load(self, sequence: int, counts: list[int]) -> bool:
        """Append a block to the FIFO once; return whether it has been appended.

        A repeated sequence number is not appended again. A block out of sequence or too long for
        the free space is refused, and the host sends it again.
        """
        if sequence == self.sequence:
            return True
        has_room = len(self._fifo) + len(counts) <= self.fifo_length
        in_turn = sequence == self.sequence + 1 and self.state in (
            DeviceState.IDLE,
            DeviceState.RUNNING,
        )
        if not (has_room and in_turn):
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
        if self.state == DeviceState.RUNNING:
            return True
        if self.state != DeviceState.IDLE or self.watchdog.latched or self.applied != self.zero:
            return False
        self.state, self.requested, self._polled = DeviceState.RUNNING, self.zero, False
        # Nobody misses what was measured before.
        self.collected = max(self.collected, self.ring.end)
        return True

    def stop(self) -> None:
        """Empty the FIFO and ramp to zero."""
        self._fifo.clear()
        if self.state == DeviceState.RUNNING:
            self.state = DeviceState.RAMPING

    def reset(self) -> bool:
        """Clear the latch; refused while the output is not zero."""
        if self.applied != self.zero:
            return False
        self.watchdog.reset()
        self.state = DeviceState.IDLE
        return True

    def hold(self, count: int) -> bool:
        """Set the output until the next value; return whether the device is running."""
        if self.state != DeviceState.RUNNING:
            return False
        self.requested, self._polled = count, True
        return True

    def watch(self, now: float) -> None:
        """Take the output to zero, latch and count if the owner has been silent too long."""
        if self.state == DeviceState.TRIPPED or not self.watchdog.expired(now):
            return
        if self.driven or self.state != DeviceState.IDLE:
            self._fifo.clear()
            self.requested, self.state = self.zero, DeviceState.TRIPPED
            self.watchdog.trip()
            self.advance(1)

    def advance(self, count: int) -> None:
        """Let ``count`` samples pass."""
        while count > 0:
            wanted, origin, position = self._next(count)
            self._apply(np.asarray(wanted, np.int64), origin, position)
            count -= len(wanted)

    def drain(self) -> None:
        """Let samples pass until the FIFO is empty or the ramp has ended: the virtual clock."""
        while self.state == DeviceState.RAMPING or (
            self.state == DeviceState.RUNNING and self._fifo
        ):
            self.advance(1 if self.state == DeviceState.RAMPING else len(self._fifo))

    def _next(self, count: int) -> tuple[list[int], Origin, int]:
        """Return at most ``count`` values to apply now, their origin and their position."""
        if self.state == DeviceState.RAMPING:
            remaining = self.zero - self.applied
            if not remaining:
                self.state, self.requested = DeviceState.IDLE, self.zero
                return [self.zero], Origin.REST, self.position
            step = min(abs(remaining), self.limits.ramp_step)
            self.requested = self.applied + (step if remaining > 0 else -step)
            return [self.requested], Origin.RAMP, self.position
        if self.state == DeviceState.RUNNING and self._fifo:
            played = [self._fifo.popleft() for _ in range(min(count, len(self._fifo)))]
            self.requested, position = played[-1], self.position
            self.position += len(played)
            return played, Origin.PLAYED, position
        if self.state == DeviceState.TRIPPED:
            return [self.zero] * count, Origin.TRIPPED, self.position
        if self._polled and self.state == DeviceState.RUNNING:
            return [self.requested] * count, Origin.POLLED, self.position
        if self.requested == self.zero:
            return [self.zero] * count, Origin.REST, self.position
        self.underruns += count
        return [self.requested] * count, Origin.HELD, self.position

    def _apply(self, wanted: NDArray[np.int64], origin: Origin, position: int) -> None:
        inside = np.clip(wanted, self.limits.low, self.limits.high)
        self.clamped += int(np.count_nonzero(inside != wanted))
        applied, displacement = self.plant.advance(inside.astype(np.uint16))
        self.ring.append(applied, displacement, origin, position)
        self.applied, self.displacement = int(applied[-1]), int(displacement[-1])
        if self.state == DeviceState.RUNNING:
            oldest = self.ring.end - self.ring.length
            self.overruns += max(0, oldest - max(self.collected, oldest - inside.size))
