"""Methods that name, or make up for, what a simulation is missing, on the same records."""
