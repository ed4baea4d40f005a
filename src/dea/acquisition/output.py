"""The right to drive an output: taken from a device that is at zero, given back at zero."""

from dea.acquisition.command_line import typed
from dea.acquisition.laws import Laws, TripError
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import applied_register, read_back_register
from dea.acquisition.retrying_link import DeviceRefusedError, Link, LinkError
from dea.acquisition.verify import answering_as_described, open_described, verify_device
from dea.errors import InputError
from dea.modbus import Command, DeviceState, Refusal, to_physical

# Failures after which nothing has been done, as the log of a link counts them: function, address or
# value are none of the device's.
NOT_DONE = {"exception 1", "exception 2", "exception 3"}


class TakenError(LinkError):
    """Another master owns the outputs."""


class NotArmedError(InputError):
    """The device does not know the switch of the high voltage as described, so that it is off."""


class Output:
    """The output of a device, and the right to drive it.

    Parameters
    ----------
    link
        The connection, not yet open.
    reset
        Whether a latched watchdog is reset when the output is taken; otherwise it is refused.
    token
        What claims the outputs of a device that has owners.

    ``trusted`` says whether the read-back has not been found wrong.
    """

    def __init__(self, link: Link, *, reset: bool = False, token: int = 1) -> None:
        self.panel, self.link, self.device = Panel(link), link, link.device
        self.reset = reset
        self._token, self.trusted = token, True
        self.laws = Laws(self.panel)

    def take(self) -> None:
        """Connect, compare the device with its description and claim the outputs.

        Raises
        ------
        InputError
            Where the device does not answer, is not the one described, is driven, is owned by
            another master, has tripped, or breaks its safety model.
        """
        open_described(self.link)
        try:
            with answering_as_described(self.device):
                verify_device(self.panel)
            self._refuse_latched()
            self._refuse_while_driven()
            if "claim" in self.panel:
                self._claim()
                self.link.on_connect = self.reclaim
            resettable = self.reset and "command" in self.panel
            if resettable and self.panel.get("state") == DeviceState.TRIPPED:
                self.panel.set("command", Command.RESET)
                self._refuse_while_driven()
            self._refuse_unsafe()
        except BaseException:
            self.link.close()
            raise

    def arm(self) -> None:
        """Switch the high voltage on.

        Raises
        ------
        NotArmedError
            Where the description of the switch is wrong.
        LinkError, DeviceRefusedError
            Where it may be on: the write may have been carried out.
        """
        before = self.link.log.errors.copy()
        try:
            self.laws.arm()
        except DeviceRefusedError as error:
            # An attempt before this refusal may have been carried out without an answer.
            if not (self.link.log.errors - before).keys() <= NOT_DONE:
                raise
            raise NotArmedError(
                f"the high voltage cannot be switched on: {error}",
                file=self.device.source,
                field="safety.enable",
                remedy="Correct its values, and the address and table of its register.",
            ) from error

    def reclaim(self, *, retry: bool = False) -> None:
        """Claim again, on another connection; a failed request repeats this with itself.

        Raises
        ------
        TakenError
            Where another master has the outputs, which it can only have taken at zero.
        """
        if "claim" not in self.panel:
            return
        try:
            self._claim(retry=retry)
        except InputError as error:
            raise TakenError(str(error)) from error
        except DeviceRefusedError as error:
            raise LinkError(str(error)) from error

    def release(self) -> None:
        """Disarm and give the outputs back, at zero; if that fails the device's watchdog does."""
        self.laws.disarm()
        if "claim" in self.panel:
            try:
                self.panel.set("claim", 0)
            except (LinkError, DeviceRefusedError):
                self.link.log.errors["not released"] += 1

    def applied(self) -> float | None:
        """Read-back of the output, V, or None where the device has none that is right."""
        return self._read_back() if self.trusted else None

    def disputed(self) -> float:
        """What a read-back that has been found wrong says of the output, V; 0 at zero."""
        return 0.0 if self.trusted else self._beyond(self._read_back() or 0.0)

    @property
    def readable(self) -> bool:
        """Whether the device has a read-back of the output."""
        return read_back_register(self.device) is not None

    def driven(self) -> float:
        """What is left of the output, V, behind the amplifier and before it.

        0 if the monitor and the read-back are no further from it than they may be, NaN where the
        monitor reads no number.
        """
        if monitored := self.laws.monitored():
            return monitored
        return self._beyond(self.applied() or 0.0)

    def _read_back(self) -> float | None:
        echo = read_back_register(self.device)
        return float(to_physical(echo, self.panel.confirmed(echo.name))) if echo else None

    def _beyond(self, applied: float) -> float:
        """Return a read-back, V, or 0 where it is no further from it than it may be."""
        echo = applied_register(self.device)
        allowed = max(abs(self.device["output"].scale), echo.tolerance)
        return applied if abs(applied) > allowed else 0.0

    def _refuse_unsafe(self) -> None:
        try:
            self.laws.check(0.0, 0.0)
        except TripError as trip:
            raise InputError(
                str(trip), file=self.device.source, field="safety",
                remedy="Close the interlock, or clear what has tripped, and start again.",
            ) from trip  # fmt: skip

    def _claim(self, *, retry: bool = True) -> None:
        try:
            self.panel.set("claim", self._token, retry=retry)
        except DeviceRefusedError as refusal:
            if refusal.code != Refusal.NOT_ALLOWED:
                raise
            raise InputError(
                "another master owns the outputs",
                file=self.device.source,
                field="endpoint",
                remedy="End it, or wait until the device's watchdog has released them.",
            ) from None

    def _refuse_latched(self) -> None:
        if "watchdog_latched" not in self.panel or not self.panel.get("watchdog_latched"):
            return
        if not self.reset:
            raise InputError(
                "the device's watchdog has latched: an earlier host fell silent while driving",
                file=self.device.source,
                remedy="Find out why, then start with --reset.",
            )
        if "command" not in self.panel:
            raise InputError(
                "the device's watchdog has latched, and no register is described that resets it",
                file=self.device.source,
                field="registers.command",
                remedy="Reset it at the device, then start without --reset.",
            )

    def _refuse_while_driven(self) -> None:
        if driven := self.driven():
            raise InputError(
                f"the output is not zero: {driven:g} V",
                file=self.device.source,
                remedy=f"Bring it to zero first: {typed('zero', self.device)}.",
            )
