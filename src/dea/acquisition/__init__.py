"""The Modbus client that drives an actuator and records it."""

from dea.acquisition.acquire import AcquiredRecord, acquire, refuse_unarmed
from dea.acquisition.closed_loop import ClosedLoop, ControllerError
from dea.acquisition.commissioned import report_file
from dea.acquisition.flagged import clock_fault
from dea.acquisition.interrupts import Interrupted
from dea.acquisition.laws import TripError
from dea.acquisition.partial import Recovered, recover, samples_kept
from dea.acquisition.read_back import ReadBackError
from dea.acquisition.recorder import GuardianLostError
from dea.acquisition.reported import reported
from dea.acquisition.retrying_link import (
    DeviceRefusedError,
    Link,
    LinkError,
    LinkSettings,
    StoppedError,
)
from dea.acquisition.samples import BrokenRecordError, DrivenSamples, Quality, asked_for
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.voltage_plan import check_excitation
from dea.acquisition.watched import acquire_watched
from dea.acquisition.zero import ZeroNotVerifiedError

__all__ = [
    "AcquiredRecord",
    "AcquisitionSettings",
    "BrokenRecordError",
    "ClosedLoop",
    "ControllerError",
    "DeviceRefusedError",
    "DrivenSamples",
    "GuardianLostError",
    "Interrupted",
    "Link",
    "LinkError",
    "LinkSettings",
    "Quality",
    "ReadBackError",
    "Recovered",
    "StoppedError",
    "TripError",
    "ZeroNotVerifiedError",
    "acquire",
    "acquire_watched",
    "asked_for",
    "check_excitation",
    "clock_fault",
    "recover",
    "refuse_unarmed",
    "report_file",
    "reported",
    "samples_kept",
]
