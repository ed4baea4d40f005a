"""Find, name and prove the effect a simulation is missing."""
