"""Generalised frequency response functions of polynomial NARX models."""

from dea.gfrf.bands import ResponseBand, frequency_response_band, zero_input_interval
from dea.gfrf.instants import Instants
from dea.gfrf.linear_part import LinearPart, linear_part
from dea.gfrf.over_time import Grid, response_over_time
from dea.gfrf.recovery import score_recovery
from dea.gfrf.response import frequency_response, zero_input_response
from dea.gfrf.stretches import modelled_stretches

__all__ = [
    "Grid",
    "Instants",
    "LinearPart",
    "ResponseBand",
    "frequency_response",
    "frequency_response_band",
    "linear_part",
    "modelled_stretches",
    "response_over_time",
    "score_recovery",
    "zero_input_interval",
    "zero_input_response",
]
