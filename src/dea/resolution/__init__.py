"""From several explanations of a device to one, by designed experiments."""

from dea.resolution.by_hand import ByHand, experiment_page, record_key
from dea.resolution.datasets import resolution_dataset
from dea.resolution.design import Design, Forms
from dea.resolution.excitation import Limits
from dea.resolution.kept import Kept
from dea.resolution.knowledge import ANOTHER, Knowledge, Options, ResolutionOutcome
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import RecordSource, Resolution, ResolutionRound, resolve

__all__ = [
    "ANOTHER",
    "CERTIFICATE",
    "ByHand",
    "Design",
    "Forms",
    "Kept",
    "Knowledge",
    "Limits",
    "Options",
    "RecordSource",
    "Resolution",
    "ResolutionOutcome",
    "ResolutionRound",
    "experiment_page",
    "record_key",
    "resolution_dataset",
    "resolve",
]
