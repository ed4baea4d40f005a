"""The virtual actuators, their instruments and hidden effects, which no diagnosis may import."""

from dea.plant.converter import Converter
from dea.plant.hidden import EFFECTS, TRIAL_SETS, ServedRig, Trial, Use, draw_trial
from dea.plant.parameters import Parameters, read_parameters, read_plain
from dea.plant.rig import SAMPLE_PERIOD, Rig

__all__ = [
    "EFFECTS",
    "SAMPLE_PERIOD",
    "TRIAL_SETS",
    "Converter",
    "Parameters",
    "Rig",
    "ServedRig",
    "Trial",
    "Use",
    "draw_trial",
    "read_parameters",
    "read_plain",
]
