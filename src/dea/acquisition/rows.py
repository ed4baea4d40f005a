"""Samples one by one, handed on in blocks."""

import time
from collections.abc import Iterator

import numpy as np

from dea.acquisition.samples import DrivenSamples, Quality

BLOCK_TIME = 0.2  # s of samples yielded, and synced to the disk, together


class Rows:
    """Samples until they are handed on together."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._handed_on = time.monotonic()

    def add(self, *row: float) -> None:
        """Add a sample, its columns in the order of :class:`DrivenSamples`."""
        self._rows.append(row)

    def leave_out(self, number: int, counts: list[int]) -> None:
        """Add samples that are not driven, from ``number`` on."""
        for place, count in enumerate(counts, start=number):
            flag = Quality.LATE | Quality.LOST
            self.add(place, place, count, 0, 0, flag, np.nan, np.nan)

    def hold(self, number: int, indices: range, count: int) -> None:
        """Add the samples measured, but not read, while the device held an output."""
        for index in indices:
            flag = Quality.HELD | Quality.LOST
            self.add(number, index, count, 0, 0, flag, np.nan, np.nan)

    def due(self) -> Iterator[DrivenSamples]:
        """Yield the samples if the last ones were yielded long enough ago."""
        if time.monotonic() - self._handed_on > BLOCK_TIME:
            yield from self.all()
            self._handed_on = time.monotonic()

    def all(self) -> Iterator[DrivenSamples]:
        """Yield the samples."""
        rows, self._rows = self._rows, []
        if rows:
            # Each column by itself: whole numbers stay whole.
            yield DrivenSamples(*(np.array(column) for column in zip(*rows, strict=True)))
