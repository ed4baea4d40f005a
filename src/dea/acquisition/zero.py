"""The way of an output to zero volts, and what shows that it has arrived.

It begins at the voltage that was asked for last, which the guardian knows, and not at a reading,
which may be wrong. A reading is used only where nobody knows what was asked for.
"""

import math
import time
from enum import StrEnum

from dea.acquisition.duty import within_limits
from dea.acquisition.laws import TripError
from dea.acquisition.output import Output
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.errors import DeviceError
from dea.modbus import Command, DeviceState, to_counts

LONGEST_STEP = 0.2  # s of ramp in one write, however long the last one is past
READINGS = 5  # that may fail before zero is written whatever the output is at
LOOKS = 3  # that may fail, and beats: no register that is silent holds up a ramp for longer
HOLDING_PAUSE = 0.1  # s between the writes of zero during the quarantine
QUARANTINES = 3  # that one attempt lasts at most


class ZeroNotVerifiedError(DeviceError):
    """The output could not be shown to be at zero."""


class ZeroEvidence(StrEnum):
    """What shows that an output is at zero, the strongest last."""

    ANSWERED = "every write of zero was answered; the device has no register to read back"
    UNTRUSTED = "every write of zero was answered; the read-back has been found wrong"
    READ_BACK = "the read-back of the output is zero"
    MONITOR = "the monitor of the high voltage is at zero"
    RELEASED = "another master has the outputs, which the device gives away at zero alone"


class WayToZero:
    """Takes an output to zero; a call that fails is continued by the next one.

    Parameters
    ----------
    output
        The output, taken.
    ramp_rate
        V/s.
    requested
        V, asked for last; None where that is not known: the way begins at what the device reads.

    ``volts`` is what was asked for last, ``known`` whether that is known by now, and ``trip`` what
    was broken of the safety model on the way, if anything was.
    """

    def __init__(self, output: Output, *, ramp_rate: float, requested: float | None) -> None:
        self.output, self.panel, self.device = output, output.panel, output.device
        self.ramp_rate, self.volts = ramp_rate, requested or 0.0
        self.known, self._readings = requested is not None, READINGS
        self._written = time.monotonic()
        self.trip: TripError | None = None
        self._looks = LOOKS if self.device.safety else 0
        self._beats = LOOKS

    def __call__(self) -> ZeroEvidence:
        """Ramp to zero, keep it there for the quarantine, and say what shows it.

        Raises
        ------
        LinkError, DeviceRefusedError, ZeroNotVerifiedError
            Where this attempt failed. Another one continues the ramp where this one ended.
        """
        self.output.reclaim(retry=True)
        if "command" in self.device:
            self._stop()
        else:
            self._ramp()
        self._hold()
        self._verify()
        self.output.release()
        return self._evidence()

    def _stop(self) -> None:
        """Let the device itself ramp."""
        if self.panel.get("state") != DeviceState.TRIPPED:
            self.panel.set("command", Command.STOP)
        limits = self.device["output"].limits or (0.0, 0.0)
        deadline = time.monotonic() + 2 * max(map(abs, limits)) / self.ramp_rate + 2
        while self.panel.confirmed("state") not in (DeviceState.IDLE, DeviceState.TRIPPED):
            self._beat()
            self._look()
            if time.monotonic() > deadline:
                raise ZeroNotVerifiedError("the device does not end its ramp to zero")
            time.sleep(0.01)
        self.volts = 0.0

    def _ramp(self) -> None:
        """Write ever lower voltages, no faster in time than the ramp's rate."""
        if not self.known:
            self._find()
        while self.volts:
            passed = min(time.monotonic() - self._written, LONGEST_STEP)
            left = max(abs(self.volts) - self.ramp_rate * passed, 0.0)
            target = math.copysign(left, self.volts) if left else 0.0
            self.panel.set("output", int(to_counts(self.device["output"], target)))
            self.volts, self._written = target, time.monotonic()
            self._beat()
            self._look()
            self.output.link.rest(min(1 / self.device.sampling_rate, LONGEST_STEP))
        self.panel.set("output", self.panel.zero)
        self.known = True

    def _find(self) -> None:
        """Begin at what the device reads; where it reads nothing time and again, at zero.

        A step to zero is then better than a voltage that is left on.
        """
        try:
            self.volts = within_limits(self.device, self.output.applied() or 0.0)
            self._written, self.known = time.monotonic(), True
        except (LinkError, DeviceRefusedError):
            self._readings -= 1
            if self._readings > 0:
                raise

    def _beat(self) -> None:
        """Give the sign of life; one that is not answered does not keep the output up."""
        if not self._beats:
            return
        try:
            self.output.laws.beat()
        except (LinkError, DeviceRefusedError):
            self._beats -= 1

    def _look(self) -> None:
        """Note a trip while there still is voltage; nothing that is read here ends the ramp."""
        if not self._looks or self.trip is not None:
            return
        try:
            self.output.laws.check_conditions()
        except TripError as trip:
            self.trip = trip
        except (LinkError, DeviceRefusedError):
            self._looks -= 1

    def _hold(self) -> None:
        """Hold zero until no write can be on its way any more.

        A gateway may carry out a write long after its reply was given up. Zero is written again and
        again, and the time begins anew when something else is read, but not for ever.
        """
        quarantine = self.device.quarantine
        begun = time.monotonic()
        end = begun + quarantine
        while time.monotonic() < end:
            self.output.link.rest(HOLDING_PAUSE)
            if "command" not in self.device:
                self.panel.set("output", self.panel.zero)
            self._beat()
            if driven := self.output.driven():
                end = time.monotonic() + quarantine
                if end > begun + QUARANTINES * quarantine:
                    raise ZeroNotVerifiedError(
                        f"the output reads {driven:g} V though zero is written again and again"
                    )

    def _verify(self) -> None:
        if driven := self.output.driven():
            raise ZeroNotVerifiedError(f"the output reads {driven:g} V after the ramp to zero")
        # A read-back that disagreed may have been right: the device may not have done as it said.
        if self.output.laws.safety.monitor is None and (read := self.output.disputed()):
            raise ZeroNotVerifiedError(
                f"the read-back, which has disagreed with what was written, reads {read:g} V"
            )

    def _evidence(self) -> ZeroEvidence:
        if self.output.laws.safety.monitor is not None:
            return ZeroEvidence.MONITOR
        if not self.output.trusted:
            return ZeroEvidence.UNTRUSTED
        return ZeroEvidence.READ_BACK if self.output.readable else ZeroEvidence.ANSWERED
