"""Generalised frequency response functions of polynomial NARX models."""
