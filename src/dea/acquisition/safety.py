"""The right to drive an output, from a verified zero volts to a verified zero volts."""

import time
from secrets import randbits

from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import DeviceRefusedError, Link, LinkError
from dea.acquisition.verify import verify_device
from dea.acquisition.voltage_plan import ramp
from dea.errors import DeviceError, InputError
from dea.modbus import to_counts, to_physical

IDLE, TRIPPED = 0, 3  # state
STOP, RESET = 2, 3  # command
NOT_ALLOWED = 7  # Modbus exception code


class ZeroNotVerifiedError(DeviceError):
    """The output could not be read back as zero."""


class SafeOutput:
    """The right to drive a device's output, from a verified zero to a verified zero.

    A context manager: on entry it connects, checks the device and claims the outputs; on every exit
    it ramps to zero and reads the zero back.

    Parameters
    ----------
    link
        The connection, not yet open.
    ramp_rate
        V/s.
    reset
        Whether a latched watchdog is reset; otherwise the start is refused.
    """

    def __init__(self, link: Link, *, ramp_rate: float, reset: bool = False) -> None:
        self.panel, self.link, self.device = Panel(link), link, link.device
        self.ramp_rate, self.reset = ramp_rate, reset
        self.zero = int(to_counts(self.device["output"], 0.0))
        self._token = randbits(31) + 1

    def __enter__(self) -> Panel:
        self._open()
        try:
            self._verify()
            self._refuse_while_driven()
            if "claim" in self.panel:
                self._claim()
                self.link.on_connect = self._reclaim
            if "state" in self.panel and self.reset and self.panel.get("state") == TRIPPED:
                self.panel.set("command", RESET)
        except BaseException:
            self.link.close()
            raise
        return self.panel

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.link.check = None
        try:
            if kind is not None:
                # A reply to an earlier request may still arrive.
                self.link.close()
            self.to_zero()
        finally:
            self.link.on_connect = None
            self.link.close()

    def to_zero(self) -> None:
        """Ramp the output to zero, read it back and release the outputs.

        Raises
        ------
        ZeroNotVerifiedError
            Where the device cannot be reached, or does not read back zero.
        """
        try:
            if "claim" in self.panel:
                # The watchdog may have released the outputs of a silent owner.
                self._reclaim(retry=True)
            if "command" in self.device:
                self._stop()
            else:
                self._ramp_down()
            if driven := self._driven():
                raise ZeroNotVerifiedError(
                    f"the output reads {driven:g} V after the ramp to zero. "
                    "Switch the amplifier off."
                )
        except (LinkError, DeviceRefusedError) as error:
            watch = "watchdog_time" in self.device
            raise ZeroNotVerifiedError(
                f"the output could not be read back as zero ({error}). "
                + (
                    "The device's watchdog takes it to zero."
                    if watch
                    else "The device has no watchdog: switch the amplifier off."
                )
            ) from error
        if "claim" in self.panel:
            self._release()

    def _open(self) -> None:
        try:
            self.link.open()
        except LinkError as error:
            raise InputError(
                str(error), file=self.device.source, field="endpoint",
                remedy="Correct host and port, or switch the device on.",
            ) from error  # fmt: skip

    def _verify(self) -> None:
        try:
            verify_device(self.panel)
        except (LinkError, DeviceRefusedError) as error:
            raise InputError(
                f"the device does not answer as described: {error}",
                file=self.device.source, field="unit_id, registers",
                remedy="Correct the unit id or the register map.",
            ) from error  # fmt: skip

    def _claim(self, *, retry: bool = True) -> None:
        try:
            self.panel.set("claim", self._token, retry=retry)
        except DeviceRefusedError as refusal:
            if refusal.code != NOT_ALLOWED:
                raise
            raise InputError(
                "another master owns the outputs",
                file=self.device.source,
                field="endpoint",
                remedy="End it, or wait until the device's watchdog has released them.",
            ) from None

    def _reclaim(self, *, retry: bool = False) -> None:
        """Claim again, on another connection; a failed request repeats this with itself."""
        try:
            self._claim(retry=retry)
        except (InputError, DeviceRefusedError) as error:
            raise LinkError(str(error)) from error

    def _release(self) -> None:
        """Release the outputs, at zero; if that fails the device's watchdog does it."""
        try:
            self.panel.set("claim", 0)
        except (LinkError, DeviceRefusedError):
            self.link.log.errors["not released"] += 1

    def _refuse_while_driven(self) -> None:
        if "watchdog_latched" in self.panel and self.panel.get("watchdog_latched"):
            if not self.reset:
                raise InputError(
                    "the device's watchdog has latched: an earlier host fell silent while driving",
                    file=self.device.source,
                    remedy="Find out why, then start with --reset.",
                )
        elif driven := self._driven():
            raise InputError(
                f"the output is not zero: {driven:g} V",
                file=self.device.source,
                remedy="Bring it to zero first; no start from a driven output.",
            )

    def _applied(self) -> float | None:
        """Read-back of the output, V, or None where the device has none."""
        for name in ("applied_output", "output"):
            if name in self.panel and self.device[name].access != "write":
                return float(to_physical(self.device[name], self.panel.confirmed(name)))
        return None

    def _driven(self) -> float:
        """Read-back of the output, V; 0 if within one count of it, or without a read-back."""
        applied = self._applied() or 0.0
        return applied if abs(applied) > abs(self.device["output"].scale) else 0.0

    def _stop(self) -> None:
        if self.panel.get("state") != TRIPPED:
            self.panel.set("command", STOP)
        limits = self.device["output"].limits or (0.0, 0.0)
        deadline = time.monotonic() + 2 * max(map(abs, limits)) / self.ramp_rate + 2
        while self.panel.confirmed("state") not in (IDLE, TRIPPED):
            if time.monotonic() > deadline:
                raise ZeroNotVerifiedError("the device does not end its ramp to zero")
            time.sleep(0.01)

    def _ramp_down(self) -> None:
        start = self._applied()
        if start is None:
            last = self.panel.last_output
            start = float(to_physical(self.device["output"], self.zero if last is None else last))
        for count in ramp(self.device, start, 0.0, self.ramp_rate).tolist():
            self.panel.set("output", count)
            time.sleep(1 / self.device.sampling_rate)
        self.panel.set("output", self.zero)
