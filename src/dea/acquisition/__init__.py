"""The Modbus client that drives an actuator and records it."""

from dea.acquisition.acquire import Acquisition, acquire
from dea.acquisition.interrupts import Interrupted
from dea.acquisition.partial import Recovered, recover
from dea.acquisition.read_back import ReadBackError
from dea.acquisition.retrying_link import DeviceRefusedError, Link, LinkError, LinkSettings
from dea.acquisition.safety import ZeroNotVerifiedError
from dea.acquisition.samples import BrokenRecordError, Quality, Samples
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.voltage_plan import check_excitation

__all__ = [
    "Acquisition",
    "AcquisitionSettings",
    "BrokenRecordError",
    "DeviceRefusedError",
    "Interrupted",
    "Link",
    "LinkError",
    "LinkSettings",
    "Quality",
    "ReadBackError",
    "Recovered",
    "Samples",
    "ZeroNotVerifiedError",
    "acquire",
    "check_excitation",
    "recover",
]
