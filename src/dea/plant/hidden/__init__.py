"""Blind trials: what can be wrong with a device and its instruments, drawn and sealed."""

from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.draw import draw as draw_trial
from dea.plant.hidden.effect import TRIAL_SETS, Use
from dea.plant.hidden.rig import ServedRig
from dea.plant.hidden.trial import Trial

__all__ = ["EFFECTS", "TRIAL_SETS", "ServedRig", "Trial", "Use", "draw_trial"]
