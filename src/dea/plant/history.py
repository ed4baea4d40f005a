"""What the rig applied and measured, sample by sample."""

import numpy as np
from numpy.typing import NDArray

_FIELDS = np.dtype(
    [
        ("applied_counts", np.uint16),
        ("displacement_counts", np.uint16),
        ("displacement", np.float64),
        ("film_voltage", np.float64),
    ]
)


class History:
    """A growing array of every sample since the start; sample k has device index k."""

    def __init__(self) -> None:
        self._samples = np.empty(1024, dtype=_FIELDS)
        self._length = 0

    def __len__(self) -> int:
        return self._length

    def append(
        self,
        applied: NDArray[np.uint16],
        measured: NDArray[np.uint16],
        displacement: NDArray[np.float64],
        film_voltage: NDArray[np.float64],
    ) -> None:
        """Add samples; ``displacement`` is the true one in m, ``film_voltage`` in V."""
        end = self._length + applied.size
        if end > self._samples.size:
            grown = np.empty(max(end, 2 * self._samples.size), dtype=_FIELDS)
            grown[: self._length] = self._samples[: self._length]
            self._samples = grown
        columns = (applied, measured, displacement, film_voltage)
        for name, column in zip(_FIELDS.names or (), columns, strict=True):
            self._samples[name][self._length : end] = column
        self._length = end

    def samples(self) -> NDArray[np.void]:
        """Return a copy of all samples.

        A structured array with fields ``applied_counts``, ``displacement_counts``,
        ``displacement`` (m, before the sensor) and ``film_voltage`` (V).
        """
        return self._samples[: self._length].copy()
