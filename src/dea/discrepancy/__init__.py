"""Find, name and prove the effect a simulation is missing."""

from dea.discrepancy.decision import Rules
from dea.discrepancy.diagnose import Diagnosis, Settings, diagnose
from dea.discrepancy.report.datasets import (
    candidates_dataset,
    certificate_dataset,
    localisation_dataset,
)
from dea.discrepancy.report.verdict import Estimate, NamedEffect, Verdict, read_verdict
from dea.discrepancy.search.rounds import Budget

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
