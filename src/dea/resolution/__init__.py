"""From several explanations of a device to one, by designed experiments."""

from dea.resolution.by_hand import excitation_table, experiment_page
from dea.resolution.datasets import resolution_dataset
from dea.resolution.design import Design, Forms
from dea.resolution.excitation import Limits
from dea.resolution.knowledge import ANOTHER, Knowledge, Options, Outcome
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import Desk, Resolution, Round, resolve

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
