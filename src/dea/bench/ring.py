"""The ring buffer of the samples that the device last applied and measured."""

from bisect import bisect_right
from dataclasses import dataclass
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.modbus import Origin

Counts = NDArray[np.uint16]


@dataclass(frozen=True)
class Run:
    """Consecutive samples of one origin; the first has ``position`` in the sequence fed."""

    index: int
    position: int
    origin: Origin
    applied: Counts
    displacement: Counts


class Stretch(NamedTuple):
    """Samples of one origin from index ``begin`` on; the first has ``position`` in the sequence."""

    begin: int
    position: int
    origin: Origin

    @property
    def moves(self) -> bool:
        """Whether the position grows by one with each sample."""
        return self.origin == Origin.PLAYED


class Ring:
    """The last ``length`` samples and their origins; ``end`` is the index of the next one."""

    def __init__(self, length: int) -> None:
        self.length, self.end = length, 0
        self._applied, self._measured = np.zeros((2, length), np.uint16)
        self._stretches = [Stretch(0, 0, Origin.REST)]

    def append(self, applied: Counts, measured: Counts, origin: Origin, position: int) -> None:
        """Add samples of one origin; the first has ``position`` in the sequence fed."""
        slots = np.arange(self.end, self.end + applied.size) % self.length
        self._applied[slots], self._measured[slots] = applied, measured
        self._note(origin, position)
        self.end += applied.size

    def run(self, index: int, limit: int) -> Run:
        """Up to ``limit`` samples of one origin, from ``index`` or the oldest one in the ring."""
        first = min(max(index, self.end - self.length, 0), self.end)
        after = bisect_right(self._stretches, first, key=attrgetter("begin"))
        stretch, end = self._stretches[after - 1], min(first + limit, self.end)
        if after < len(self._stretches):
            end = min(end, self._stretches[after].begin)
        slots = np.arange(first, end) % self.length
        position = stretch.position + (first - stretch.begin) * stretch.moves
        return Run(first, position, stretch.origin, self._applied[slots], self._measured[slots])

    def _note(self, origin: Origin, position: int) -> None:
        """Begin a stretch if the next sample does not continue the last one."""
        last = self._stretches[-1]
        expected = last.position + (self.end - last.begin) * last.moves
        if (origin, position) != (last.origin, expected):
            self._stretches.append(Stretch(self.end, position, origin))
            oldest = self.end - self.length
            while len(self._stretches) > 1 and self._stretches[1].begin <= oldest:
                del self._stretches[0]
