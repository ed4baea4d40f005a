"""From fitted candidates to a name, several, none, or "unknown"."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from dea.discrepancy.evidence.bootstrap import Gains, beaten
from dea.discrepancy.evidence.certificate import Certified, certify, contradicting
from dea.discrepancy.evidence.colour import is_coloured_noise
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.presence import Presence, Share, families_of, share_removed
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.problem import rmse
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.search.candidates import Candidate, EffectSet
from dea.discrepancy.search.rounds import Round

_CERTIFIED = "certified samples"
# Candidates of one size whose held-out errors are compared.
_LEADING = 6


class Status(StrEnum):
    """The outcomes of a diagnosis."""

    NAMED = "named"
    NONE = "none"
    AMBIGUOUS = "ambiguous"
    UNKNOWN = "unknown"


class Reason(StrEnum):
    """Why no single effect set is named, or not all of the answer."""

    ACCURATE = "the simulation is as good as it is said to be"
    NOISE = "the residual is at the noise floor"
    IRREDUCIBLE = "no effect and no flexible model reduces the residual"
    COLOURED = "the residual is coloured noise, which follows neither the input nor the motion"
    NO_EFFECT = "no effect of the catalogue is sure to reduce the residual"
    UNEXPLAINED = "the best effect leaves too much unexplained"
    REMAINS = "what remains is not named"
    RIVAL = "a rival explains the record as well"
    ONLY_CERTIFIED = "only the certified samples show it"
    OF_ONE_RECORD = "the best effect does not serve on the records left out"
    CONTRADICTED = "the best effect fails on the certified samples"
    CONTRADICTED_ELSEWHERE = "the best effect fails on the test records"


@dataclass(frozen=True)
class Decision:
    """The status, the chosen candidate and, where it is not alone, its rivals.

    An answer that is not ``whole`` is a certain part of it: something else is missing, too. The
    reason ``COLOURED`` of a whole one says what it leaves. Where samples not used so far have
    withdrawn it, ``contradicted`` holds the errors on those that did, by the name of the record.
    """

    status: Status
    chosen: Candidate | None
    rivals: tuple[Candidate, ...] = ()
    reason: Reason | None = None
    whole: bool = True
    contradicted: Mapping[str, Certified] = field(default_factory=dict)

    @property
    def answer(self) -> Candidate | None:
        """The candidate that is named, with or without rivals."""
        return self.chosen if self.status in (Status.NAMED, Status.AMBIGUOUS) else None

    def noise(self, rules: Rules, floor: float) -> float:
        """Return the error up to which an answer leaves noise: that which it is named beside."""
        if self.reason is Reason.COLOURED and self.answer is not None:
            floor = max(floor, self.answer.rmse)
        return rules.clean * floor


def proven_alone(rounds: Sequence[Round], gained: Gains, rules: Rules) -> list[Candidate]:
    """Return the single effects whose gain is beyond the margin and beyond chance, best first."""
    needed = max(rules.needed_gain, gained.null)
    pairs = zip(rounds[0].candidates, gained.low, strict=True)
    return [c for c, low in pairs if c.finished and low > needed]


def sure_alone(evidence: Evidence, rounds: Sequence[Round], weighed: Presence) -> list[Candidate]:
    """Return the single effects that are certain and leave noise alone where there was more.

    The gain of an effect that acts rarely, such as a limit that is seldom reached, varies so much
    between blocks that it is not proven by their resampling.
    """
    rules, floor, before = evidence.rules, evidence.floor, evidence.nominal_error
    sure = weighed.sure(rules.certain)
    singles = (c for c in rounds[0].candidates if c.finished and c.effects <= sure)
    return [c for c in singles if rules.completes(c.rmse, before, floor)]


def best_extension(
    evidence: Evidence, rounds: Sequence[Round], proven: Sequence[Candidate]
) -> Candidate | None:
    """Return the best single effect that is proven, or the best larger set that helps more.

    Of those whose held-out errors are as good as the best, down to the noise, it is the one with
    the least freedom.
    """
    held_out, floor, rules = evidence.held_out, evidence.floor, evidence.rules

    def simplest(candidates: Sequence[Candidate]) -> Candidate:
        leading = sorted(candidates, key=lambda c: c.error)[:_LEADING]
        errors = {id(c): held_out.rmse(c.fit) for c in leading}
        best = min(errors.values())
        equal = [c for c in leading if rules.as_good(errors[id(c)], best, evidence.noise)]
        return min(equal, key=lambda c: (round(c.freedom), errors[id(c)]))

    chosen = simplest(proven) if proven else None
    larger = [c for r in rounds[1:] for c in r.candidates if c.finished]
    for size in sorted({len(c.names) for c in larger}):
        best = simplest([c for c in larger if len(c.names) == size])
        before = chosen.fit if chosen else rounds[0].before
        _, low = beaten(best.fit.residual, before.residual, evidence.blocks, evidence.rng)
        # What leaves noise alone is right, though a course in time that few blocks show may be
        # extrapolated badly.
        left = evidence.problem.seen_rmse(before.residual)
        complete = rules.completes(best.rmse, left, floor)
        if not complete and held_out.rmse(best.fit) >= held_out.rmse(before):
            continue
        if chosen is None:
            # Two effects at once, neither of which is proven alone, must remove twice the margin.
            if low > -np.log1p(-2 * rules.margin):
                chosen = best
            continue
        needed = rules.leaves_room(chosen.rmse, evidence.nominal_error, floor)
        if len(families_of(best)) < len(best.names):
            whole = misfit(evidence.nominal_error, floor)
            needed = needed and misfit(chosen.rmse, floor) > 4 * rules.room * whole
        most = (1.0 - rules.second) * misfit(chosen.rmse, floor)
        if needed and low > rules.needed_gain and misfit(best.rmse, floor) <= most:
            chosen = best
    return chosen


def decide(
    evidence: Evidence,
    chosen: Candidate | None,
    pool: Sequence[Candidate],
    proven: Sequence[Candidate],
    residual: np.ndarray,
    weighed: Presence,
) -> Decision:
    """Name the chosen candidate, or the part of it that is certain, unless something is against it.

    ``pool`` holds all candidates, ``proven`` the single effects whose gain is significant,
    ``residual`` (n,) is that of the simulation alone.
    """
    error, rules = evidence.nominal_error, evidence.rules
    if error <= rules.noise_like * evidence.accuracy:
        return Decision(Status.NONE, None, reason=Reason.ACCURATE)
    surest = weighed.surest(rules.certain)
    if surest is not None and _stands_alone(evidence, surest, pool, weighed):
        return Decision(Status.NAMED, surest, reason=_rest(evidence, surest, weighed))
    if chosen is None:
        return _nothing_proven(evidence, residual)
    if not (_explained(evidence, chosen, weighed) and _each_adds(evidence, chosen, pool)):
        part = _certain_part(evidence, pool, weighed)
        if part is not None:
            return Decision(Status.NAMED, part, reason=Reason.REMAINS, whole=False)
        # If an effect lowers the error on held-out blocks, the residual is not noise.
        unaffected = _share_of(evidence, chosen).low <= rules.margin
        if unaffected and is_coloured_noise(evidence.problem, residual, evidence.blocks):
            return Decision(Status.NONE, None, reason=Reason.COLOURED)
        return Decision(Status.UNKNOWN, chosen, reason=Reason.UNEXPLAINED)
    rivals = _rivals(evidence, chosen, pool)
    leaves_noise = chosen.rmse <= rules.clean * evidence.floor
    if weighed.least_of(chosen) <= 1.0 - (rules.certain if leaves_noise else rules.likely):
        # The evidence is against a part of it, whatever is predicted on blocks left out.
        rivals += [c for c in weighed.candidates[:1] if c.effects != chosen.effects]
    if not rivals:
        akin = tuple(_rivals(evidence, chosen, pool, akin=True))
        sure = max(weighed.least_of(chosen), weighed.among(chosen, akin)) >= rules.certain
        if sure or not akin:
            return Decision(Status.NAMED, chosen, akin, _rest(evidence, chosen, weighed))
        return Decision(Status.AMBIGUOUS, chosen, akin, Reason.RIVAL)
    shared = chosen.effects.intersection(*(rival.effects for rival in rivals))
    for candidate in proven:
        # If many second effects do as well, the shared one is certain, and the second one stands
        # for an error of its law.
        if (
            len(chosen.names) > 1
            and candidate.effects == shared
            and _explained(evidence, candidate, weighed)
            and not _rivals(evidence, candidate, pool)
        ):
            return Decision(Status.NAMED, candidate)
    part = _certain_part(evidence, pool, weighed) if len(chosen.names) > 1 else None
    if part is not None:
        return Decision(Status.NAMED, part, reason=Reason.REMAINS, whole=False)
    return Decision(Status.AMBIGUOUS, chosen, tuple(rivals), Reason.RIVAL)


def _stands_alone(
    evidence: Evidence, surest: Candidate, pool: Sequence[Candidate], weighed: Presence
) -> bool:
    """Return whether the explanation that the evidence leaves alone is good enough to be named.

    Blocks left out, of which there may be few, need not tell it from its rivals. But the simulation
    alone must leave more than noise, and no other single effect nearly the same misfit, unless that
    predicts blocks left out much worse. Pairs bend to what they see: none may have nearly the error
    of another. A part must leave room for the rest.
    """
    rules, floor = evidence.rules, evidence.floor
    if evidence.nominal_error <= rules.clean * floor or not _explained(evidence, surest, weighed):
        return False
    if not _each_adds(evidence, surest, pool):
        return False

    def stands_against(other: Candidate) -> bool:
        if other.effects < surest.effects:
            return not rules.leaves_room(other.rmse, evidence.nominal_error, floor)
        if len(other.names) != len(surest.names) or other.effects == surest.effects:
            return False
        if len(surest.names) > 1:
            return other.error <= rules.rival_margin * surest.error
        if not rules.as_good(other.error, surest.error, evidence.noise):
            return False
        predicted, rivalling = (evidence.held_out.residual(c.fit) for c in (surest, other))
        worse, low = beaten(predicted, rivalling, evidence.blocks, evidence.rng)
        # With few blocks, resampling often omits the one that separates them.
        return low <= rules.needed_gain and worse <= np.log(rules.near)

    if any(stands_against(c) for c in pool if c.finished):
        return False
    # A drift or hum of a sensor is common: held-out blocks must show its course in time.
    laws = [a.effect for a in surest.fit.extended.attached]
    of_readings = any(law.only_reads and not law.transferable for law in laws)
    complete = rules.completes(surest.rmse, evidence.nominal_error, floor)
    return (complete and not of_readings) or _share_of(evidence, surest).low >= rules.part


def _nothing_proven(evidence: Evidence, residual: np.ndarray) -> Decision:
    """Say whether a residual that no effect reduces is noise."""
    rules = evidence.rules
    unpredictable = residual_model(evidence.problem, residual).ratio > 1.0 - rules.margin
    if unpredictable and evidence.nominal_error <= rules.clean * evidence.floor:
        return Decision(Status.NONE, None, reason=Reason.NOISE)
    if unpredictable and evidence.nominal_error <= rules.noise_like * evidence.floor:
        return Decision(Status.NONE, None, reason=Reason.IRREDUCIBLE)
    if is_coloured_noise(evidence.problem, residual, evidence.blocks):
        return Decision(Status.NONE, None, reason=Reason.COLOURED)
    return Decision(Status.UNKNOWN, None, reason=Reason.NO_EFFECT)


def _certain_part(
    evidence: Evidence, pool: Sequence[Candidate], weighed: Presence
) -> Candidate | None:
    """Return the effect that is certain, if it explains most of the gap, or several that are.

    Whatever else the answer holds, these effects are in it. The best explanation without one of
    them and any of its family must leave much more of the misfit than the best one with all, since
    an effect that the catalogue lacks is often half explained by several.
    """
    rules, floor = evidence.rules, evidence.floor
    sure = weighed.sure(rules.certain)
    finished = [c for c in pool if c.finished]
    families = {
        c.fit.extended.name_of(a): a.effect.family
        for c in finished
        for a in c.fit.extended.attached
    }

    def ahead(part: Candidate, name: str, given: EffectSet = frozenset()) -> bool:
        """Return whether what holds no effect of the family, but those given, leaves much more."""
        kin = {other for other, family in families.items() if family is families[name]} - given
        within = min(c.rmse for c in finished if c.effects >= part.effects)
        without = min((c.rmse for c in finished if not c.effects & kin), default=np.inf)
        return misfit(within, floor) <= (1.0 - rules.ahead) * misfit(without, floor)

    certain = sorted((c for c in finished if c.effects <= sure), key=lambda c: c.error)
    alone = (c for c in certain if len(c.names) == 1 and ahead(c, c.names[0]))
    part = next((c for c in alone if _share_of(evidence, c).low >= rules.part), None)
    if part is None:
        return None

    def completed_by(wider: Candidate) -> bool:
        further = wider.effects - part.effects
        return all(ahead(wider, name, part.effects) for name in further) and _each_adds(
            evidence, wider, pool
        )

    return next((c for c in certain if c.effects > part.effects and completed_by(c)), part)


def _each_adds(evidence: Evidence, chosen: Candidate, pool: Sequence[Candidate]) -> bool:
    """Return whether each of several effects removes much of what the others leave.

    On blocks that were not fitted: a second law bends to the error of the first one's law, too,
    where it has seen it.
    """
    if len(chosen.effects) == 1:
        return True

    def left(candidate: Candidate) -> float:
        return misfit(evidence.held_out.rmse(candidate.fit), evidence.floor)

    most = [
        (1.0 - evidence.rules.part) * left(min(others, key=lambda c: c.rmse))
        for effect in chosen.effects
        if (others := [c for c in pool if c.finished and c.effects == chosen.effects - {effect}])
    ]
    return left(chosen) <= min(most, default=np.inf)


def _share_of(evidence: Evidence, part: Candidate) -> Share:
    held_out = evidence.held_out
    before, after = held_out.residual(evidence.nominal), held_out.residual(part.fit)
    return share_removed(before, after, evidence.blocks, evidence.floor, evidence.rng)


def confirmed(
    decision: Decision,
    evidence: Evidence,
    left_out: Mapping[str, Certified],
    tested: Mapping[str, Certified],
) -> Decision:
    """Withdraw what the certified samples contradict, or other records of the device.

    They choose nothing. ``left_out`` are the errors on records of a joint diagnosis that were left
    out in turn, ``tested`` those on test records. These do not contradict ``none``, which says what
    the records that were diagnosed could show.
    """
    problem, nominal, rules = evidence.problem, evidence.nominal, evidence.rules
    answer = decision.answer
    if answer is None:
        coloured = decision.reason is Reason.COLOURED
        level = evidence.nominal_error if coloured else evidence.floor
        left = rmse(nominal.residual, problem.certify)
        if decision.status is Status.NONE and left > rules.noise_like * level:
            return Decision(Status.UNKNOWN, None, reason=Reason.ONLY_CERTIFIED)
        return decision
    noise = decision.noise(rules, evidence.floor)
    block = {_CERTIFIED: certify(problem, nominal, answer.fit)}
    for reason, found, allowed in (
        (Reason.CONTRADICTED, block, noise),
        (Reason.OF_ONE_RECORD, left_out, 0.0),
        (Reason.CONTRADICTED_ELSEWHERE, tested, noise),
    ):
        against = contradicting(found, allowed)
        if against:
            return Decision(Status.UNKNOWN, answer, reason=reason, contradicted=against)
    return decision


def same_class(first: Candidate, second: Candidate) -> bool:
    """Return whether the effects in which two candidates differ are of the same families.

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
    return len(own) == len(other) and all(any(a.family is b.family for b in other) for a in own)


def _explained(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether too little is left over for another effect to be hidden in it."""
    floor, rules = evidence.floor, evidence.rules
    if chosen.rmse <= rules.clean * floor:
        return True
    # Several laws together fit almost any residual, so that they must leave noise alone.
    if len(chosen.names) > 1 and chosen.rmse > rules.grow * floor:
        return False
    left, whole = misfit(chosen.rmse, floor), misfit(evidence.nominal_error, floor)
    if left > rules.misfit * whole:
        return _leaves_coloured_noise(evidence, chosen, weighed)
    if left <= 0.5 * rules.misfit * whole:
        return True
    return residual_model(evidence.problem, chosen.fit.residual).ratio >= rules.predictable


def _rest(evidence: Evidence, chosen: Candidate, weighed: Presence) -> Reason | None:
    """Return what an effect that is named leaves, if it is known as noise beyond the floor."""
    beyond = chosen.rmse > evidence.rules.clean * evidence.floor
    noise = beyond and _leaves_coloured_noise(evidence, chosen, weighed)
    return Reason.COLOURED if noise else None


def _leaves_coloured_noise(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether most of the gap is explained, and the rest is noise that follows nothing.

    What a further effect surely explains is no noise.
    """
    if _share_of(evidence, chosen).low < evidence.rules.part:
        return False
    if weighed.wider_than(chosen) >= evidence.rules.certain:
        return False
    return is_coloured_noise(evidence.problem, chosen.fit.residual, evidence.blocks)


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
