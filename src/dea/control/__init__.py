"""From model to control: code, linear models and trackers that run beside a device."""

from dea.control.c_code import CCode, c_identifier, to_c
from dea.control.feedback import Follower, Gains, tune_feedback
from dea.control.fmu import write_fmu
from dea.control.inverse import inverse_input
from dea.control.iosystem import to_iosystem
from dea.control.linear import Linearised, linearise, linearise_over_time
from dea.control.online import OnlineTracker

__all__ = [
    "CCode",
    "Follower",
    "Gains",
    "Linearised",
    "OnlineTracker",
    "c_identifier",
    "inverse_input",
    "linearise",
    "linearise_over_time",
    "to_c",
    "to_iosystem",
    "tune_feedback",
    "write_fmu",
]
