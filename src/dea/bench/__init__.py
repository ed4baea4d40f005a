"""The virtual test bench: the only room that knows how the actuators really work."""
