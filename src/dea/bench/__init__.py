"""The virtual test bench: the only room that knows how the actuators really work."""

from dea.bench.rig import SAMPLE_PERIOD, Rig

# The drawing of trials needs the rig, which is therefore imported first.
from dea.bench.hidden.draw import draw as draw_trial  # isort: skip
from dea.bench.hidden.trial import Trial  # isort: skip

__all__ = ["SAMPLE_PERIOD", "Rig", "Trial", "draw_trial"]
