"""The laws of :mod:`dea.plant.forces`: constants c, memory m, place y and velocity v."""
