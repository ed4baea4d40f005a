"""Checks that the register of the applied output holds what is played.

It alone shows whether the output is zero, so that a wrong address, a wrong scale or a reading that
stands still must not go unnoticed. A polled device is checked with every sample, a buffered one,
which sends what it applied along with its samples, once.
"""

from collections import deque

import numpy as np

from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.errors import DeviceError
from dea.modbus import Device, DeviceState, Register, to_physical

LAG = 1  # samples that a read-back may always be behind
STRIKES = 3  # samples in a row whose read-back is wrong until it is not trusted any more


class ReadBackError(DeviceError):
    """The register of the applied output does not hold what the device plays."""


def read_back_register(device: Device) -> Register | None:
    """Return the register that says what output is applied, None where the device has none."""
    named = (device.registers.get(name) for name in ("applied_output", "output"))
    return next((each for each in named if each and each.access != "write"), None)


def applied_register(device: Device) -> Register:
    """Return the register that says what is applied; where none does, what was written stands."""
    return read_back_register(device) or device["output"]


class ReadBack:
    """Compares one reading with what was played around it, while the output is far from zero.

    Parameters
    ----------
    panel
        Of a device that plays; one without ``applied_output`` and ``state`` is not checked.
    counts
        The output counts it plays.
    tolerance
        Deviation that is no error, as a share of the span of the output's limits.
    """

    def __init__(self, panel: Panel, counts: np.ndarray, tolerance: float) -> None:
        self.panel = panel
        # volts[k] is applied after k samples.
        self.volts = np.append(0.0, to_physical(panel.device["output"], counts))
        low, high = panel.device["output"].limits or (0.0, 0.0)
        self.tolerance = tolerance * (high - low)
        self.pending = "applied_output" in panel and "state" in panel
        self._reading: tuple[int, float] | None = None

    def __call__(self, position: int) -> None:
        """Read the register after ``position`` samples were played, and check the last reading.

        Raises
        ------
        ReadBackError
            Where the last reading is none of the values played between it and this one.
        """
        if self.pending and self._reading is not None:
            self._check(*self._reading, position)
        self._reading = self._read(position) if self.pending else None

    def _read(self, position: int) -> tuple[int, float] | None:
        if not self._clear_of_zero(self.volts[position]):
            return None
        try:
            applied = to_physical(
                self.panel.device["applied_output"], self.panel.confirmed("applied_output")
            )
            running = self.panel.confirmed("state") == DeviceState.RUNNING
        # Reconnecting, or the value changes: another reading follows.
        except (LinkError, DeviceRefusedError):
            return None
        return (position, float(applied)) if running else None

    def _check(self, start: int, applied: float, end: int) -> None:
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
        """Whether a register of zeros differs from these by more than the tolerance."""
        return bool(np.min(np.abs(volts)) > 2 * self.tolerance)


class Echo:
    """Compares the read-back of every sample with what was asked for, polled around it.

    Parameters
    ----------
    panel
        Of the device.
    name
        The register that is read back.
    tolerance
        Deviation that is no error, as a share of the span of the output's limits; the register's
        own ``tolerance`` if that is more.
    """

    def __init__(self, panel: Panel, name: str, tolerance: float) -> None:
        device = panel.device
        self.output, self.register, self.source = device["output"], device[name], device.source
        low, high = self.output.limits or (0.0, 0.0)
        self.tolerance = max(tolerance * (high - low), self.register.tolerance)
        self._asked: deque[float] = deque(maxlen=LAG + 1)
        self._wrong = 0

    def right(self, counts: np.ndarray | float, applied: np.ndarray | float) -> np.ndarray:
        """Return, sample by sample, whether what was applied is what was asked for; all raw."""
        asked, found = to_physical(self.output, counts), to_physical(self.register, applied)
        return np.asarray(np.abs(found - asked) <= self.tolerance)

    def __call__(self, count: int, applied: float) -> bool:
        """Return whether the raw read-back of one sample is what was asked for with it.

        Raises
        ------
        ReadBackError
            Where it has too often in a row been neither that nor what was asked for just before.
        """
        asked = self.output.offset + self.output.scale * count
        self._asked.append(asked)
        found = self.register.offset + self.register.scale * applied
        low, high = min(self._asked), max(self._asked)
        if low - self.tolerance <= found <= high + self.tolerance:
            self._wrong = 0
            return abs(found - asked) <= self.tolerance
        self._wrong += 1
        if self._wrong >= STRIKES:
            raise ReadBackError(
                f"{self.source}: registers.{self.register.name}: it reads {found:g} V while "
                f"{low:g} to {high:g} V were asked for, so that it cannot say whether the output "
                "is at zero. Correct its address, type or range, or find out why it stands still."
            )
        return False
