"""Generalised frequency response functions of polynomial NARX models."""

from dea.gfrf.over_time import response_over_time
from dea.gfrf.response import frequency_response, zero_input_response

__all__ = ["frequency_response", "response_over_time", "zero_input_response"]
