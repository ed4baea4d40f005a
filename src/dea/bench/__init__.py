"""The virtual test bench: the only room that knows how the actuators really work."""

from dea.bench.rig import SAMPLE_PERIOD, Rig

__all__ = ["SAMPLE_PERIOD", "Rig"]
