"""From several explanations of a device to one, by designed experiments."""

from dea.resolution.by_hand import excitation_table, experiment_page
from dea.resolution.datasets import resolution_dataset
from dea.resolution.design import Design, Forms
from dea.resolution.excitation import Limits
from dea.resolution.rounds import (
    ANOTHER,
    CERTIFICATE,
    Desk,
    Knowledge,
    Options,
    Outcome,
    Resolution,
    Round,
    resolve,
)

__all__ = [
    "ANOTHER",
    "CERTIFICATE",
    "Design",
    "Desk",
    "Forms",
    "Knowledge",
    "Limits",
    "Options",
    "Outcome",
    "Resolution",
    "Round",
    "excitation_table",
    "experiment_page",
    "resolution_dataset",
    "resolve",
]
