"""Generalised frequency response functions of polynomial NARX models."""

from dea.gfrf.over_time import Grid, response_over_time
from dea.gfrf.recovery import score_recovery
from dea.gfrf.response import frequency_response, zero_input_response

__all__ = [
    "Grid",
    "frequency_response",
    "response_over_time",
    "score_recovery",
    "zero_input_response",
]
