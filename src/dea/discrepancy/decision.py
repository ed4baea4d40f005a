"""From fitted candidates to a name, several, none, or an honest "unknown"."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.evidence.confusion import beaten
from dea.discrepancy.evidence.gain import HeldOut
from dea.discrepancy.evidence.residual_model import ResidualModel, residual_model
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem, rmse
from dea.discrepancy.search.rounds import Candidate

# Part of the noise floor below which no misfit is told from another.
_NEGLIGIBLE = 0.05
# Noise floors up to which a residual that nothing narrows counts as noise.
_BARELY = 1.5
# Errors of the chosen candidate beyond which another is not worth a fit without each fold.
_NEAR = 2.5


@dataclass(frozen=True)
class Rules:
    """When a name is given. Every figure may be changed in the config.

    Parameters
    ----------
    margin
        Part of the held-out error that an effect must remove, at the lower end of its interval.
    clean
        A residual up to this many noise floors counts as explained.
    misfit
        Part of the nominal misfit (root mean square above the floor) that may remain.
    further
        Factor on it for each effect beyond the first: two laws bend to anything more easily.
    grow
        A further effect is looked for where more than this many noise floors are left, or more of
        the misfit than may remain.
    second
        A further effect must remove this part of the misfit that is left; a law that is only
        nearly right leaves crumbs, of which any second one takes up a few.
    rival_margin
        A rival of another class is beaten if its misfit is larger by this factor, and surely so.
    predictable
        A flexible model that lowers the remaining error below this part of it says that
        something else is missing.
    """

    margin: float = 0.10
    clean: float = 1.15
    misfit: float = 0.25
    further: float = 0.4
    grow: float = 1.25
    second: float = 0.65
    rival_margin: float = 1.05
    predictable: float = 0.80


@dataclass(frozen=True)
class Decision:
    """The status, the chosen candidate and, where it is not alone, its rivals."""

    status: str
    chosen: Candidate | None
    rivals: tuple[Candidate, ...] = ()
    reason: str = ""


@dataclass(frozen=True)
class Evidence:
    """What candidates are judged by.

    Parameters
    ----------
    held_out
        Gaps on blocks that the parameters have not seen.
    blocks
        Blocks of the seen samples, that are drawn from with replacement.
    nominal_error
        What the simulation alone leaves over (root mean square).
    noise
        Noise floor, down to which rivals are told apart.
    accuracy
        How well the simulation is said to describe the device.
    rng
        Draws of the blocks.

    Errors are in the output's unit.
    """

    problem: Problem
    held_out: HeldOut
    blocks: Sequence[slice]
    nominal_error: float
    noise: float
    accuracy: float
    rules: Rules
    rng: np.random.Generator

    @property
    def floor(self) -> float:
        """What may be left over: the noise, and what the simulation is said to miss."""
        return float(np.hypot(self.noise, self.accuracy))


def misfit(error: float, floor: float) -> float:
    """Return what an error holds beyond the noise floor (root mean square)."""
    return float(np.sqrt(max(error**2 - floor**2, 0.0)))


def leaves_room(error: float, nominal_error: float, floor: float, rules: Rules) -> bool:
    """Return whether an error leaves room for a further effect."""
    if error <= rules.clean * floor:
        return False
    left, whole = misfit(error, floor), misfit(nominal_error, floor)
    return error > rules.grow * floor or left > rules.misfit * whole


def as_good(other: Candidate, best: Candidate, floor: float, rules: Rules) -> bool:
    """Return whether a candidate's misfit is that of the best, or nearly so."""
    left = max(misfit(best.error, floor), _NEGLIGIBLE * floor)
    return misfit(other.error, floor) <= rules.rival_margin * left


def decide(
    evidence: Evidence,
    chosen: Candidate | None,
    pool: Sequence[Candidate],
    proven: Sequence[Candidate],
    unexplained: ResidualModel,
) -> Decision:
    """Name the chosen candidate unless something speaks against it.

    ``pool`` holds all candidates, ``proven`` the single effects that help for sure.
    """
    error, floor, rules = evidence.nominal_error, evidence.floor, evidence.rules
    if error <= _BARELY * evidence.accuracy:
        return Decision("none", None, reason="the simulation is as good as it is said to be")
    if chosen is None:
        if error <= rules.clean * floor and unexplained.ratio > 1.0 - rules.margin:
            return Decision("none", None, reason="the gap is at the noise floor")
        if unexplained.ratio > 1.0 - rules.margin and error <= _BARELY * floor:
            return Decision("none", None, reason="no effect and no flexible model narrows the gap")
        return Decision("unknown", None, reason="no effect of the catalogue narrows the gap")
    if not _explained(evidence, chosen, unexplained):
        return Decision("unknown", chosen, reason="the best effect leaves too much unexplained")
    rivals = _rivals(evidence, chosen, pool)
    if not rivals:
        return Decision("named", chosen, tuple(_rivals(evidence, chosen, pool, akin=True)))
    shared = set(chosen.names).intersection(*(rival.names for rival in rivals))
    for candidate in proven:
        # Many seconds do as well: the first is sure, and what is left of it a law of another form.
        if (
            len(chosen.names) > 1
            and candidate.names == tuple(shared)
            and _explained(
                evidence, candidate, residual_model(evidence.problem, candidate.fit.residual)
            )
            and not _rivals(evidence, candidate, pool)
        ):
            return Decision("named", candidate)
    return Decision("ambiguous", chosen, tuple(rivals), "a rival explains the record as well")


def confirmed(decision: Decision, evidence: Evidence, nominal: Fit) -> Decision:
    """Withdraw what the samples kept for proof contradict; they choose nothing."""
    certify, floor = evidence.problem.certify, evidence.floor
    before = rmse(nominal.residual, certify)
    if decision.status == "none" and before > _BARELY * floor:
        return Decision("unknown", None, reason="only the samples kept for proof show it")
    if decision.status in ("named", "ambiguous") and decision.chosen is not None:
        after = rmse(decision.chosen.fit.residual, certify)
        if after > max(before, evidence.rules.clean * floor):
            reason = "the best effect fails on the samples kept for proof"
            return Decision("unknown", decision.chosen, reason=reason)
    return decision


def same_class(first: Candidate, second: Candidate) -> bool:
    """Return whether the effects in which two candidates differ share their port or their physics.

    Such effects are one class: seen from outside they are hard, or impossible, to tell apart.
    """
    own, other = (
        [
            a.effect
            for a in mine.fit.extended.attached
            if mine.fit.extended.label(a) not in theirs.labels
        ]
        for mine, theirs in ((first, second), (second, first))
    )
    return len(own) == len(other) and all(
        any(a.port is b.port or a.family is b.family for b in other) for a in own
    )


def _explained(evidence: Evidence, chosen: Candidate, unexplained: ResidualModel) -> bool:
    """Return whether too little is left over for another effect to be hidden in it."""
    floor, rules = evidence.floor, evidence.rules
    if chosen.rmse <= rules.clean * floor:
        return True
    left, whole = misfit(chosen.rmse, floor), misfit(evidence.nominal_error, floor)
    if left > rules.misfit * whole * rules.further ** (len(chosen.names) - 1):
        return False
    return unexplained.ratio >= rules.predictable or left <= 0.5 * rules.misfit * whole


def _rivals(
    evidence: Evidence, chosen: Candidate, pool: Sequence[Candidate], akin: bool = False
) -> list[Candidate]:
    """Return the candidates that explain the record as well: of another class, or of the same.

    Those near the chosen one are compared with it on blocks that neither was fitted to: the freer
    of two laws bends to more.
    """
    held_out = evidence.held_out
    rivals = []
    known = {frozenset(chosen.names)}
    for other in pool:
        if len(other.names) != len(chosen.names) or not other.finished:
            continue
        if frozenset(other.names) in known or same_class(chosen, other) is not akin:
            continue
        known.add(frozenset(other.names))
        residuals = chosen.fit.residual, other.fit.residual
        if other.error <= _NEAR * chosen.error:
            residuals = held_out.residual(chosen.fit), held_out.residual(other.fit)
        _, low = beaten(*residuals, evidence.blocks, evidence.rng)
        if low <= 0 or as_good(other, chosen, evidence.noise, evidence.rules):
            rivals.append(other)
    return rivals
