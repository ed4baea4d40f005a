"""From model to control: code, linear models and trackers that run beside a device."""

from dea.control.c_code import CCode, c_identifier, to_c
from dea.control.fmu import write_fmu
from dea.control.iosystem import to_iosystem
from dea.control.linear import Linearised, linearise, linearise_over_time
from dea.control.online import OnlineTracker

__all__ = [
    "CCode",
    "Linearised",
    "OnlineTracker",
    "c_identifier",
    "linearise",
    "linearise_over_time",
    "to_c",
    "to_iosystem",
    "write_fmu",
]
