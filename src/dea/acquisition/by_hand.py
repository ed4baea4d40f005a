"""What a person does to an output: look at it, take it to zero, dismiss its guardian."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from dea.acquisition.command_line import typed
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.duty import ALARMING, Notice, Order, Phase, duty_file, end, look, order
from dea.acquisition.interrupts import Interruption
from dea.acquisition.latch import latch_file, trip
from dea.acquisition.link_log import LinkLog
from dea.acquisition.output import Output
from dea.acquisition.recorder import Recorder
from dea.acquisition.retrying_link import BY_HAND, Link
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.transport import known
from dea.acquisition.zero import ZeroNotVerifiedError
from dea.errors import DeviceError, InputError
from dea.modbus import Device
from dea.progress import tell

SILENT = 3.0  # s without a sign of life that are reported
LONGER = 3.0  # s that this waits longer for one than the guardian's recorder does
IN_VAIN = 5  # attempts to end one

_DOING = {
    Phase.NEVER: "nothing was driven since this machine started",
    Phase.CHECKING: "checks the device",
    Phase.DRIVING: "drives",
    Phase.TO_ZERO: "ramps to zero",
    Phase.ALARM: "ALARM: cannot show that the output is at zero",
    Phase.AT_ZERO: "has shown that the output is at zero",
    Phase.DISMISSED: "was dismissed before zero was shown",
    Phase.REFUSED: "was refused before it had driven anything",
    Phase.UNKEPT: "has shown that the output is at zero; the disk has not taken its trip",
}


def status(device: Device) -> str:
    """Return lines on an output's guardian, its trip and, without a guardian, its reading."""
    device = known(device)
    notice = look(duty_file(device))
    lines = [_guardian(notice)]
    if (tripped := trip(device)) is not None:
        lines.append(f"tripped at {tripped['time']}: {tripped['reason']}")
    if not notice.alive:
        lines.append(f"the output {_reading(device)}")
    return "\n".join(lines)


def _reading(device: Device) -> str:
    """Say what the output reads; a device that is off must not hide what is known besides."""
    link = Link(device, BY_HAND)
    try:
        applied = Output(link).applied()
    except (DeviceError, InputError) as error:
        return f"cannot be read: {error}"
    finally:
        link.close()
    return "has no read-back" if applied is None else f"reads {applied:g} V"


def zero(device: Device, settings: AcquisitionSettings) -> str:
    """Take an output to zero, whoever drives it on this machine; return what shows it.

    What its guardian does meanwhile is told as progress. One that gives no sign of life is killed,
    and followed by another. The ramp is no faster than the safety model allows.

    Raises
    ------
    ZeroNotVerifiedError
        Where it cannot be shown yet, for longer than ``reconnect_time``; a guardian goes on trying.
    DeviceError
        Where it is shown, and the guardian cannot end: for as long, no disk has taken its trip.
    InputError
        Where another master owns the outputs, or a guardian that gives no sign of life is another
        user's.
    Interrupted
        On a signal, once zero is shown.
    """
    allowed = device.safety.max_rate if device.safety else None
    if allowed is not None and settings.ramp_rate > allowed:
        tell(f"{device.name}: the ramp is one of {allowed:g} V/s, as safety.max_rate allows")
        settings = replace(settings, ramp_rate=allowed)
    device = known(device)
    path = duty_file(device)
    watched, in_alarm = _Watched(path, settings), 0.0
    while (notice := look(path)).alive:
        in_alarm = (in_alarm or time.monotonic()) if notice.phase in ALARMING else 0.0
        if in_alarm and time.monotonic() - in_alarm >= settings.reconnect_time:
            if notice.phase == Phase.UNKEPT:
                raise DeviceError(
                    f"{device.name}: {_guardian(notice)}. Make room in {latch_file(device).parent}"
                )
            raise ZeroNotVerifiedError(
                f"{device.name}: {_guardian(notice)}. It goes on trying: switch the amplifier off."
            )
        order(path, Order.ZERO)
        tell(f"{device.name}: {_guardian(notice)}")
        if watched.ended(notice):
            tell(f"{device.name}: guardian {notice.process} was killed, another follows")
        time.sleep(1.0)
    log = LinkLog()
    nothing = np.zeros(0, np.int64)
    job = DriveJob(
        device, settings, nothing, reset=False, token=0,
        latch=latch_file(device), started=log.started,
    )  # fmt: skip
    interruption = Interruption()
    with interruption, Recorder(job, log, interruption.check) as recorder:
        recorder.await_zero()
    return recorder.evidence


def dismiss(device: Device) -> str:
    """End a guardian that raises its alarm: somebody has switched the amplifier off.

    Returns what has become of it.

    Raises
    ------
    InputError
        Where no guardian raises one.
    """
    path = duty_file(known(device))
    watched = _Watched(path, AcquisitionSettings())
    notice = look(path)
    if not (notice.alive and notice.phase in ALARMING):
        raise InputError(
            f"no guardian raises an alarm: {_guardian(notice)}",
            file=device.source,
            remedy=f"Take the output to zero: {typed('zero', device)}.",
        )
    while notice.alive and notice.phase in ALARMING:
        order(path, Order.DISMISS)
        watched.ended(notice)
        time.sleep(0.1)
        notice = look(path)
    return _guardian(notice)


class _Watched:
    """A guardian that is looked at again and again, and ended where it is silent for too long.

    That is longer than its recorder, which looks too, would have waited.
    """

    def __init__(self, path: Path, settings: AcquisitionSettings) -> None:
        self._path, self._usual = path, settings.patience
        self._before: Notice | None = None
        self._in_vain = 0

    def ended(self, notice: Notice) -> bool:
        """Return whether it was ended now, and another is to follow.

        Raises
        ------
        InputError
            Where it cannot be ended from here.
        """
        before, self._before = self._before, notice
        # An earlier version of this program tells of no signs of life.
        silent = notice.beat and notice.silent > (notice.patience or self._usual) + LONGER
        # Twice the same: this process may have stood still itself.
        if not silent or notice != before:
            return False
        if end(self._path, notice):
            return True
        self._in_vain += look(self._path) == notice
        if self._in_vain > IN_VAIN:
            raise InputError(
                f"the guardian, process {notice.process}, gives no sign of life and cannot be "
                "ended from here",
                file=self._path,
                remedy="Switch the amplifier off; end the process where it was started.",
            )
        return False


def _guardian(notice: Notice) -> str:
    doing = _DOING[notice.phase]
    if notice.abandoned and notice.phase != Phase.DISMISSED:
        doing = "was killed before it had shown zero"
    if notice.phase == Phase.NEVER:
        return doing
    since = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(notice.changed))
    if notice.silent > SILENT:
        doing += f", but has given no sign of life for {notice.silent:.0f} s: `zero` replaces it"
    return f"guardian {notice.process} {doing}; asked for {notice.requested:g} V ({since})"
