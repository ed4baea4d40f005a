"""The safety model of a device at work: what is checked with every sample, and what breaks it."""

import math
import time
from collections import deque

from dea.acquisition.panel import Panel
from dea.configuration.safety import Monitor, Safety
from dea.errors import DeviceError

HISTORY = 2  # sample periods that a measurement may always be behind


class TripError(DeviceError):
    """A condition of the safety model does not hold; it latches until somebody acknowledges it."""


class Laws:
    """Arms a device, checks its safety model, gives its sign of life, and disarms it.

    A device without ``safety`` has nothing to check.
    """

    def __init__(self, panel: Panel) -> None:
        self.panel, self.device = panel, panel.device
        self.safety = self.device.safety or Safety()
        self.interval = self.safety.interval if self.device.safety else float("inf")
        self._asked: deque[tuple[float, float, float]] = deque()  # time, lowest and highest V
        self._beats, self._beaten, self._checked = 0, -math.inf, -math.inf

    def arm(self) -> None:
        """Switch the high voltage on; a write without a reply may have been carried out."""
        if (enable := self.safety.enable) is not None:
            self.panel.set(enable.name, enable.on)

    def disarm(self) -> None:
        """Switch the high voltage off."""
        if (enable := self.safety.enable) is not None:
            self.panel.set(enable.name, enable.off)

    def beat(self) -> None:
        """Give the sign of life where it is due."""
        heartbeat, now = self.safety.heartbeat, time.monotonic()
        if heartbeat is not None and now - self._beaten >= heartbeat.period:
            self._beats, self._beaten = (self._beats + 1) % 2**15, now
            self.panel.set(heartbeat.name, self._beats)

    def due(self) -> bool:
        """Whether the last check is as long ago as it may be."""
        return time.monotonic() - self._checked >= self.interval

    def check(self, low: float, high: float) -> None:
        """Check everything while the output, V, is between ``low`` and ``high``.

        Raises
        ------
        TripError
            Naming the condition that does not hold.
        """
        self._checked = time.monotonic()
        self.beat()
        self.check_conditions()
        if (monitor := self.safety.monitor) is not None:
            self._check_monitor(monitor, low, high)

    def check_conditions(self) -> None:
        """Check interlocks and current, whatever the output is.

        Raises
        ------
        TripError
            Naming the condition that does not hold.
        """
        for name, condition in self.safety.interlocks.items():
            found = self.panel.get(condition.name)
            if found != condition.value:
                raise TripError(f"interlock {name}: {condition.name} reads {found}")
        if (bound := self.safety.current) is not None:
            current = self.panel.number(bound.name)
            if not abs(current) < bound.limit:
                unit = self.device[bound.name].unit
                raise TripError(f"the current is {current:g} {unit}, at most {bound.limit:g}")

    def monitored(self) -> float | None:
        """Return the output, V, that the monitor shows beyond its tolerance; None without one.

        NaN where the monitor reads no number: that is no evidence of zero.
        """
        if (monitor := self.safety.monitor) is None:
            return None
        off = self.panel.number(monitor.name) - monitor.offset
        return 0.0 if abs(off) <= monitor.tolerance else off / monitor.gain

    def _check_monitor(self, monitor: Monitor, low: float, high: float) -> None:
        now = time.monotonic()
        self._asked.append((now, low, high))
        behind = monitor.delay + HISTORY / self.device.sampling_rate
        while len(self._asked) > 1 and self._asked[1][0] < now - behind:
            self._asked.popleft()
        ends = [
            monitor.gain * volts + monitor.offset
            for _, lowest, highest in self._asked
            for volts in (lowest, highest)
        ]
        found = self.panel.number(monitor.name)
        if not min(ends) - monitor.tolerance <= found <= max(ends) + monitor.tolerance:
            unit = self.device[monitor.name].unit
            raise TripError(
                f"the monitor of the high voltage reads {found:g} {unit}, where "
                f"{min(ends):g} to {max(ends):g} are due"
            )
