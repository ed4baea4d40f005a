"""Find, name and certify the effect that a simulation is missing."""

from dea.discrepancy.diagnose import diagnose
from dea.discrepancy.diagnosis import Diagnosis
from dea.discrepancy.report.datasets import (
    candidates_dataset,
    certificate_dataset,
    localisation_dataset,
)
from dea.discrepancy.report.verdict import Estimate, NamedEffect, Verdict, read_verdict
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.budget import Budget
from dea.discrepancy.settings import Settings

__all__ = [
    "Budget",
    "Diagnosis",
    "Estimate",
    "NamedEffect",
    "Rules",
    "Settings",
    "Verdict",
    "candidates_dataset",
    "certificate_dataset",
    "diagnose",
    "localisation_dataset",
    "read_verdict",
]
