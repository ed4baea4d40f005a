"""Find, name and certify the effect that a simulation is missing."""

from dea.discrepancy.budget import Budget
from dea.discrepancy.decision import Reason, Status
from dea.discrepancy.diagnose import diagnose
from dea.discrepancy.diagnosis import Diagnosis
from dea.discrepancy.evidence.certificate import Certified, certify_elsewhere, transferable
from dea.discrepancy.evidence.model_error import memory_of
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.fitting.sensitivity import sensitivities
from dea.discrepancy.problem.problem import Problem, Samples
from dea.discrepancy.problem.records import SAME_INTERVAL, signals_of
from dea.discrepancy.problem.split import shortest_record
from dea.discrepancy.report.datasets import (
    candidates_dataset,
    certificate_dataset,
    localisation_dataset,
)
from dea.discrepancy.report.simulations import save_simulation
from dea.discrepancy.report.verdict import Estimate, NamedEffect, Verdict, read_verdict
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.settings import Settings

__all__ = [
    "SAME_INTERVAL",
    "Budget",
    "Candidate",
    "Certified",
    "Diagnosis",
    "Estimate",
    "Fit",
    "NamedEffect",
    "Problem",
    "Reason",
    "Rules",
    "Samples",
    "Settings",
    "Status",
    "Verdict",
    "candidates_dataset",
    "certificate_dataset",
    "certify_elsewhere",
    "diagnose",
    "localisation_dataset",
    "memory_of",
    "misfit",
    "read_verdict",
    "save_simulation",
    "sensitivities",
    "shortest_record",
    "signals_of",
    "transferable",
]
