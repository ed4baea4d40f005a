"""Blind trials: what can be wrong with an actuator and its instruments, drawn and sealed."""

from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.draw import draw as draw_trial
from dea.plant.hidden.trial import Trial

__all__ = ["EFFECTS", "Trial", "draw_trial"]
