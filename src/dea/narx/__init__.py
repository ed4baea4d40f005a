"""Polynomial NARX models: terms, simulation, estimation, selection, validation."""
