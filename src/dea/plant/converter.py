"""Sixteen-bit converters between physical values and unsigned counts."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

HIGHEST = int(np.iinfo(np.uint16).max)


class Converter(NamedTuple):
    """A straight-binary converter: count 0 is ``low``, the highest count is ``high``."""

    low: float
    high: float

    @property
    def step(self) -> float:
        """The value of one count."""
        return (self.high - self.low) / HIGHEST

    def to_counts(self, values: NDArray[np.float64]) -> NDArray[np.uint16]:
        """Return the nearest counts, clipped to the range of the converter."""
        counts = np.rint((values - self.low) / self.step)
        return np.clip(counts, 0, HIGHEST).astype(np.uint16)

    def to_values(self, counts: NDArray[np.uint16]) -> NDArray[np.float64]:
        """Return the physical values of ``counts``."""
        return self.low + counts.astype(np.float64) * self.step
