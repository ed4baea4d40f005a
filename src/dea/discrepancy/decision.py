"""From fitted candidates to a name, several, none, or "unknown"."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dea.discrepancy.evidence.bootstrap import Gains, beaten
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.residual_model import ResidualModel, residual_model
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import rmse
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.search.candidates import Candidate
from dea.discrepancy.search.rounds import Round


class Status(StrEnum):
    """The outcomes of a diagnosis."""

    NAMED = "named"
    NONE = "none"
    AMBIGUOUS = "ambiguous"
    UNKNOWN = "unknown"


class Reason(StrEnum):
    """Why no single effect set is named."""

    ACCURATE = "the simulation is as good as it is said to be"
    NOISE = "the residual is at the noise floor"
    IRREDUCIBLE = "no effect and no flexible model reduces the residual"
    NO_EFFECT = "no effect of the catalogue reduces the residual"
    UNEXPLAINED = "the best effect leaves too much unexplained"
    RIVAL = "a rival explains the record as well"
    ONLY_CERTIFIED = "only the certified samples show it"
    CONTRADICTED = "the best effect fails on the certified samples"


@dataclass(frozen=True)
class Decision:
    """The status, the chosen candidate and, where it is not alone, its rivals."""

    status: Status
    chosen: Candidate | None
    rivals: tuple[Candidate, ...] = ()
    reason: Reason | None = None

    @property
    def answer(self) -> Candidate | None:
        """The candidate that is named, with or without rivals."""
        return self.chosen if self.status in (Status.NAMED, Status.AMBIGUOUS) else None


def proven_alone(rounds: Sequence[Round], gained: Gains, rules: Rules) -> list[Candidate]:
    """Return the single effects whose gain is beyond the margin and beyond chance, best first."""
    needed = max(rules.needed_gain, gained.null)
    pairs = zip(rounds[0].candidates, gained.low, strict=True)
    return [c for c, low in pairs if c.finished and low > needed]


def best_extension(
    evidence: Evidence, rounds: Sequence[Round], proven: Sequence[Candidate]
) -> Candidate | None:
    """Return the best single effect that is proven, or the best larger set that helps more.

    Of those that are as good as the best, down to the noise, it is the one with the fewest
    parameters.
    """
    held_out, floor, rules = evidence.held_out, evidence.floor, evidence.rules

    def simplest(candidates: Sequence[Candidate]) -> Candidate:
        best = min(candidates, key=lambda c: c.error)
        equal = [c for c in candidates if rules.as_good(c.error, best.error, evidence.noise)]
        return min(equal, key=lambda c: (c.fit.coordinates.size, c.error))

    chosen = simplest(proven) if proven else None
    larger = [c for r in rounds[1:] for c in r.candidates if c.finished]
    for size in sorted({len(c.names) for c in larger}):
        best = simplest([c for c in larger if len(c.names) == size])
        before = chosen.fit if chosen else rounds[0].before
        _, low = beaten(best.fit.residual, before.residual, evidence.blocks, evidence.rng)
        if held_out.rmse(best.fit) >= held_out.rmse(before):
            continue
        if chosen is None:
            # Two effects at once, neither of which is proven alone, must remove twice the margin.
            if low > -np.log1p(-2 * rules.margin):
                chosen = best
            continue
        needed = rules.leaves_room(chosen.rmse, evidence.nominal_error, floor)
        left = (1.0 - rules.second) * misfit(chosen.rmse, floor)
        if needed and low > rules.needed_gain and misfit(best.rmse, floor) <= left:
            chosen = best
    return chosen


def decide(
    evidence: Evidence,
    chosen: Candidate | None,
    pool: Sequence[Candidate],
    proven: Sequence[Candidate],
    unexplained: ResidualModel,
) -> Decision:
    """Name the chosen candidate unless something speaks against it.

    ``pool`` holds all candidates, ``proven`` the single effects whose gain is significant.
    """
    error, floor, rules = evidence.nominal_error, evidence.floor, evidence.rules
    if error <= rules.noise_like * evidence.accuracy:
        return Decision(Status.NONE, None, reason=Reason.ACCURATE)
    if chosen is None:
        unpredictable = unexplained.ratio > 1.0 - rules.margin
        if error <= rules.clean * floor and unpredictable:
            return Decision(Status.NONE, None, reason=Reason.NOISE)
        if unpredictable and error <= rules.noise_like * floor:
            return Decision(Status.NONE, None, reason=Reason.IRREDUCIBLE)
        return Decision(Status.UNKNOWN, None, reason=Reason.NO_EFFECT)
    if not _explained(evidence, chosen, unexplained):
        return Decision(Status.UNKNOWN, chosen, reason=Reason.UNEXPLAINED)
    rivals = _rivals(evidence, chosen, pool)
    if not rivals:
        akin = _rivals(evidence, chosen, pool, akin=True)
        return Decision(Status.NAMED, chosen, tuple(akin))
    shared = chosen.effects.intersection(*(rival.effects for rival in rivals))
    for candidate in proven:
        # If many second effects do as well, the shared one is certain, and the second one stands
        # for an error of its law.
        if (
            len(chosen.names) > 1
            and candidate.effects == shared
            and _explained(
                evidence, candidate, residual_model(evidence.problem, candidate.fit.residual)
            )
            and not _rivals(evidence, candidate, pool)
        ):
            return Decision(Status.NAMED, candidate)
    return Decision(Status.AMBIGUOUS, chosen, tuple(rivals), Reason.RIVAL)


def confirmed(decision: Decision, evidence: Evidence, nominal: Fit) -> Decision:
    """Withdraw what the certified samples contradict; they choose nothing."""
    certify, floor, rules = evidence.problem.certify, evidence.floor, evidence.rules
    before = rmse(nominal.residual, certify)
    if decision.status is Status.NONE and before > rules.noise_like * floor:
        return Decision(Status.UNKNOWN, None, reason=Reason.ONLY_CERTIFIED)
    if decision.answer is not None:
        after = rmse(decision.answer.fit.residual, certify)
        if after > max(before, rules.clean * floor):
            return Decision(Status.UNKNOWN, decision.chosen, reason=Reason.CONTRADICTED)
    return decision


def same_class(first: Candidate, second: Candidate) -> bool:
    """Return whether the effects in which two candidates differ share their port or their physics.

    Such effects form one class: a record hardly distinguishes them, or not at all.
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

    Those with a similar error are compared with it on held-out residuals, since of two laws the
    more flexible one fits better the blocks that it has seen.
    """
    held_out, rules = evidence.held_out, evidence.rules
    rivals = []
    known = {chosen.effects}
    for other in pool:
        if len(other.names) != len(chosen.names) or not other.finished:
            continue
        if other.effects in known or same_class(chosen, other) is not akin:
            continue
        known.add(other.effects)
        residuals = chosen.fit.residual, other.fit.residual
        if other.error <= rules.near * chosen.error:
            residuals = held_out.residual(chosen.fit), held_out.residual(other.fit)
        _, low = beaten(*residuals, evidence.blocks, evidence.rng)
        if low <= 0 or rules.as_good(other.error, chosen.error, evidence.noise):
            rivals.append(other)
    return rivals
