"""From model to control: code, linear models, trackers and controllers beside a device."""

from dea.control.adaptive_inverse import AdaptiveInverse, Guard, LostError, RunIn, Task
from dea.control.c_code import CCode, c_identifier, to_c
from dea.control.datasets import control_dataset
from dea.control.design import Controller, ControllerDesign
from dea.control.feedback import Follower, Gains, tune_feedback
from dea.control.fmu import write_fmu
from dea.control.inverse import inverse_input
from dea.control.iosystem import to_iosystem
from dea.control.limits import InputLimits
from dea.control.linear import Linearised, linearise, linearise_over_time
from dea.control.online import OnlineTracker
from dea.control.planning import RecedingHorizonInverse, inverse_of
from dea.control.reference import Reach, ReferenceShape, design_reference, reach_of
from dea.control.trial import ControlScheme, Followed
from dea.control.whole_inverse import whole_inverse

__all__ = [
    "AdaptiveInverse",
    "CCode",
    "ControlScheme",
    "Controller",
    "ControllerDesign",
    "Followed",
    "Follower",
    "Gains",
    "Guard",
    "InputLimits",
    "Linearised",
    "LostError",
    "OnlineTracker",
    "Reach",
    "RecedingHorizonInverse",
    "ReferenceShape",
    "RunIn",
    "Task",
    "c_identifier",
    "control_dataset",
    "design_reference",
    "inverse_input",
    "inverse_of",
    "linearise",
    "linearise_over_time",
    "reach_of",
    "to_c",
    "to_iosystem",
    "tune_feedback",
    "whole_inverse",
    "write_fmu",
]
