"""Find, name and prove the effect a simulation is missing."""

from dea.discrepancy.compose import Budget
from dea.discrepancy.datasets import (
    candidates_dataset,
    certificate_dataset,
    localisation_dataset,
)
from dea.discrepancy.decide import Rules
from dea.discrepancy.diagnose import Diagnosis, Settings, diagnose
from dea.discrepancy.effects import Effect, Family, Port, catalogue
from dea.discrepancy.extended import ExtendedSimulation
from dea.discrepancy.parameter import Parameter
from dea.discrepancy.saved import load_extended, save_extended
from dea.discrepancy.simulation import Balance, Simulation, State, load_simulation
from dea.discrepancy.verdict import Estimate, NamedEffect, Verdict, read_verdict

__all__ = [
    "Balance",
    "Budget",
    "Diagnosis",
    "Effect",
    "Estimate",
    "ExtendedSimulation",
    "Family",
    "NamedEffect",
    "Parameter",
    "Port",
    "Rules",
    "Settings",
    "Simulation",
    "State",
    "Verdict",
    "candidates_dataset",
    "catalogue",
    "certificate_dataset",
    "diagnose",
    "load_extended",
    "load_simulation",
    "localisation_dataset",
    "read_verdict",
    "save_extended",
]
