"""Generalised frequency response functions of polynomial NARX models."""

from dea.gfrf.response import frequency_response, zero_input_response

__all__ = ["frequency_response", "zero_input_response"]
