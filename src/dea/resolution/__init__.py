"""From several explanations of a device to one, by designed experiments."""

from dea.resolution.allowed import allowed_by_device, allowed_by_records
from dea.resolution.by_hand import ByHand, experiment_page, record_key
from dea.resolution.datasets import resolution_dataset
from dea.resolution.design import Design, Forms
from dea.resolution.excitation import Limits
from dea.resolution.kept import Kept
from dea.resolution.knowledge import ANOTHER, Knowledge, Options, ResolutionOutcome
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import RecordSource, Resolution, ResolutionRound, resolve
from dea.resolution.summary import said

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
    "allowed_by_device",
    "allowed_by_records",
    "experiment_page",
    "record_key",
    "resolution_dataset",
    "resolve",
    "said",
]
