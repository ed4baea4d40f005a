"""Everything that a diagnosis has found out before it is put into words."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.discrepancy.decision import Decision
from dea.discrepancy.evidence.bootstrap import Gains
from dea.discrepancy.evidence.certificate import Certificate
from dea.discrepancy.evidence.confusion import Confusion
from dea.discrepancy.evidence.contributions import Contribution, Rung
from dea.discrepancy.evidence.identifiability import Visibility
from dea.discrepancy.evidence.localisation import Localisation
from dea.discrepancy.evidence.model_error import ModelError
from dea.discrepancy.evidence.modulation import ModulatedWave
from dea.discrepancy.evidence.presence import Presence, Share
from dea.discrepancy.evidence.residual_model import ResidualModel
from dea.discrepancy.evidence.uncertainty import Uncertainty, uncertainty
from dea.discrepancy.evidence.unknown_force import UnknownForce
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import Split
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.search.not_offered import NotOffered
from dea.simulation import Input


@dataclass(frozen=True)
class Singles:
    """The single effects: their candidates, best first, their gains, and what is visible of them.

    Gains and visibilities are in the order of the candidates.
    """

    candidates: tuple[Candidate, ...]
    gains: Gains
    visibility: tuple[Visibility, ...]


@dataclass(frozen=True)
class Where:
    """Where the residual is concentrated before and after the extension."""

    before: Localisation
    after: Localisation


@dataclass(frozen=True)
class Ladder:
    """The extension step by step, and what each of its effects contributes."""

    rungs: tuple[Rung, ...]
    contributions: tuple[Contribution, ...]


@dataclass(frozen=True, repr=False)
class Findings:
    """Everything a diagnosis has found out.

    Parameters
    ----------
    problem, split
        The record, with the floor as its noise, and how it was split.
    nominal, extended
        The simulation as it was, refitted, and with the effects that are named.
    singles, pool
        The single effects with their gains, and the best candidate of every effect set tried, best
        first.
    decision
        Status, effects and reason, which the certified samples have not contradicted.
    ladder, where, confusion
        What each named effect contributes, where the residual is concentrated, and which of the
        leading effects this record would confuse.
    certificate
        Errors before and after on samples and records that chose nothing.
    noise_floor, coloured_level
        Levels of white noise and of the coloured noise beyond it, in the output's unit.
    floor, stated_floor
        What a complete simulation leaves, with and without coloured noise (:class:`Evidence`).
    presence, error
        How sure it is that each effect is part of the answer, and what the best answer leaves.
    final, spread
        The extended simulation estimated again on the whole record, and the standard deviations
        of its coordinates from fits to parts of the record.
    unexplained
        What predicts the residual of ``extended``: where nothing is named, of the simulation alone.
    share
        Part of the held-out misfit that the extension removes; none where nothing is attached.
    force
        The smooth force that predicts most of the simulation's residual, where that is unknown.
    modulated
        The wave that a disturbance leaves, changed by the motion, where the effects are unknown.
    rules
        Thresholds that the decision was made with.
    not_offered
        Effects of the catalogue that were never tried, and why.
    """

    problem: Problem
    split: Split
    nominal: Fit
    extended: Fit
    final: Fit
    spread: np.ndarray
    singles: Singles
    pool: tuple[Candidate, ...]
    decision: Decision
    ladder: Ladder
    where: Where
    unexplained: ResidualModel
    force: UnknownForce | None
    modulated: ModulatedWave | None
    confusion: Confusion
    certificate: Certificate
    noise_floor: float
    coloured_level: float
    floor: float
    stated_floor: float
    presence: Presence
    error: ModelError
    share: Share | None
    rules: Rules
    not_offered: tuple[NotOffered, ...]

    @cached_property
    def uncertainty(self) -> Uncertainty:
        """How sure the coordinates of the ``final`` simulation are."""
        return uncertainty(self.problem, self.final, self.spread, self.error)

    @cached_property
    def freed_deviation(self) -> np.ndarray:
        """Standard deviations of the coordinates of the simulation with wider priors.

        Empty where the decision has not freed it.
        """
        freed = self.decision.freed
        if freed is None:
            return np.empty(0)
        white = ModelError(self.noise_floor, 0.0, 0.0, 1.0)  # what it leaves says the rest
        return uncertainty(self.problem, freed, np.zeros(freed.coordinates.size), white).deviation

    @property
    def above_white(self) -> float:
        """RMS that the simulation alone leaves beyond white noise, on the samples seen."""
        return misfit(self.problem.seen_rmse(self.nominal.residual), self.error.white)

    @property
    def inputs(self) -> tuple[Input, ...]:
        """The inputs of the record, as the simulation calls them."""
        return self.nominal.extended.simulation.inputs

    @property
    def units(self) -> tuple[str, str]:
        """Units of input and output; different ones of several inputs are listed."""
        of_inputs = dict.fromkeys(each.unit for each in self.inputs)
        return ", ".join(of_inputs), self.nominal.extended.simulation.output_unit
