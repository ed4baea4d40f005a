"""Whether the register that tells the applied output tells what is played.

A buffered device sends what it applied along with its samples. The register alone says whether an
output is at zero before and after, so that a wrong address would make every such answer worthless.
"""

import numpy as np

from dea.acquisition.link import DeviceRefusedError, LinkError
from dea.acquisition.panel import Panel
from dea.errors import DeviceError
from dea.modbus import to_physical

RUNNING = 2  # state


class ReadBackError(DeviceError):
    """The register of the applied output does not tell what the device plays."""


class ReadBack:
    """Compares one reading with what was played around it, once the output is clear of zero.

    Parameters
    ----------
    panel
        Of a device that plays; one without ``applied_output`` and ``state`` is not asked.
    counts
        The output counts it plays.
    tolerance
        Deviation that is no error, as a share of the span of the output's limits.
    """

    def __init__(self, panel: Panel, counts: np.ndarray, tolerance: float) -> None:
        self.panel = panel
        # What is applied after so many samples; before the first, zero.
        self.volts = np.append(0.0, to_physical(panel.device["output"], counts))
        low, high = panel.device["output"].limits or (0.0, 0.0)
        self.tolerance = tolerance * (high - low)
        self.pending = "applied_output" in panel and "state" in panel
        self._seen: tuple[int, float] | None = None

    def __call__(self, position: int) -> None:
        """Look at the register after ``position`` samples were played, and judge the last look.

        Raises
        ------
        ReadBackError
            Where a running device read what it did not play between one look and the next.
        """
        if self.pending and self._seen is not None:
            self._judge(*self._seen, position)
        self._seen = self._look(position) if self.pending else None

    def _look(self, position: int) -> tuple[int, float] | None:
        if not self._clear_of_zero(self.volts[position]):
            return None
        try:
            applied = to_physical(
                self.panel.device["applied_output"], self.panel.confirmed("applied_output")
            )
            running = self.panel.confirmed("state") == RUNNING
        # The link is being repaired, or the value moves: there will be another look.
        except (LinkError, DeviceRefusedError):
            return None
        return (position, float(applied)) if running else None

    def _judge(self, start: int, applied: float, end: int) -> None:
        played = self.volts[start : end + 1]
        if not self._clear_of_zero(played):
            return
        low, high = played.min(), played.max()
        if not low - self.tolerance <= applied <= high + self.tolerance:
            raise ReadBackError(
                f"{self.panel.device.source}: registers.applied_output: it reads {applied:g} V "
                f"while {low:g} to {high:g} V are played, so that it cannot say whether the output "
                "is at zero. Correct its address, type or range."
            )
        self.pending = False

    def _clear_of_zero(self, volts: np.ndarray) -> bool:
        """Whether a register of zeros could not pass for these."""
        return bool(np.min(np.abs(volts)) > 2 * self.tolerance)
