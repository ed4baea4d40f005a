"""First-principles simulations, and the catalogue of effects that can be attached to them."""

from dea.simulation.attached import Attached
from dea.simulation.effects import Effect, Family, Port, catalogue, low_pass
from dea.simulation.extended import ExtendedSimulation, samples_of_each
from dea.simulation.files_read import files_read
from dea.simulation.force_port import ForcePort
from dea.simulation.inputs import Input
from dea.simulation.interpolation import InputInterpolation, at_steps
from dea.simulation.law_course import LawCourse, law_courses
from dea.simulation.loading import load_simulation
from dea.simulation.normalisation import Normalisation
from dea.simulation.parameter import TIMING_OFFSET, Parameter
from dea.simulation.preparation import (
    MotionRange,
    measured_scales,
    motion,
    prepared,
    slowest_time,
    with_fine_steps,
)
from dea.simulation.saved import load_extended, save_extended
from dea.simulation.scales import Scales
from dea.simulation.sensor_filter import SensorFilter
from dea.simulation.shaped_input import ShapedInput
from dea.simulation.signatures import FORCE, SLOTS
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

__all__ = [
    "FORCE",
    "SLOTS",
    "TIMING_OFFSET",
    "Attached",
    "Effect",
    "ExtendedSimulation",
    "Family",
    "ForcePort",
    "Input",
    "InputInterpolation",
    "LawCourse",
    "MotionRange",
    "Normalisation",
    "Parameter",
    "Port",
    "Scales",
    "SensorFilter",
    "ShapedInput",
    "Simulation",
    "State",
    "at_steps",
    "catalogue",
    "files_read",
    "law_courses",
    "load_extended",
    "load_simulation",
    "low_pass",
    "measured_scales",
    "motion",
    "prepared",
    "samples_of_each",
    "save_extended",
    "slowest_time",
    "with_fine_steps",
]
