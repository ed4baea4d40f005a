"""Fits of the simulation and of its extensions to a record."""
