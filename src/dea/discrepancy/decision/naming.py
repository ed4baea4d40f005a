"""From the best extension and its rivals to a name, several, none, or "unknown"."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.decision.adequacy import borne_out, rest_of, share_of, suffices
from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.decision.parts import certain_part, each_adds
from dea.discrepancy.decision.rivals import rivals_of, same_class
from dea.discrepancy.evidence.bootstrap import beaten
from dea.discrepancy.evidence.certificate import has_course_of_reading
from dea.discrepancy.evidence.colour import (
    follows_no_force,
    is_coloured_noise,
    is_white,
    leaves_coloured_noise,
)
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.presence import Presence, families_of
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import at_prior_bounds


def decide(
    evidence: Evidence,
    chosen: Candidate | None,
    pool: Sequence[Candidate],
    proven: Sequence[Candidate],
    weighed: Presence,
) -> Decision:
    """Name the chosen candidate, or the part of it that is certain, unless something is against it.

    ``pool`` holds all candidates, ``proven`` the single effects whose gain is significant.
    """
    error, rules, alone = evidence.nominal_error, evidence.rules, evidence.nominal
    if error <= rules.noise_like * evidence.accuracy:
        return Decision(Status.NONE, None, reason=Reason.ACCURATE)
    if chosen is not None:
        chosen = _with_what_is_certain(weighed, chosen, rules.certain)
    surest = _surest(weighed, chosen, rules.certain)
    if surest is not None and _stands_alone(evidence, surest, pool, weighed):
        return Decision(Status.NAMED, surest, reason=rest_of(evidence, surest, weighed))
    if chosen is None:
        return _nothing_proven(evidence)
    if not (suffices(evidence, chosen, weighed) and each_adds(evidence, chosen, pool)):
        part = certain_part(evidence, pool, weighed, with_others=True)
        if part is not None:
            return Decision(Status.NAMED, part, reason=Reason.REMAINS, whole=False)
        # If an effect lowers the error on held-out blocks, the residual is not noise.
        unaffected = share_of(evidence, chosen.fit).low <= rules.margin
        if (
            unaffected
            and not at_prior_bounds(alone)
            and leaves_coloured_noise(evidence.problem, alone, evidence.blocks, rules.may_follow())
        ):
            return Decision(Status.NONE, None, reason=Reason.COLOURED)
        return Decision(Status.UNKNOWN, chosen, reason=Reason.UNEXPLAINED)
    rivals = rivals_of(evidence, chosen, pool)
    is_clean = chosen.rmse <= rules.clean * evidence.stated_floor
    likeliest = next((c for c in weighed.candidates if c.effects != chosen.effects), None)
    if weighed.least_of(chosen) < (1.0 - rules.certain if is_clean else rules.likely):
        # The evidence is not for all of it, whatever is predicted on blocks left out.
        if likeliest is None:
            return Decision(Status.UNKNOWN, chosen, reason=Reason.NO_EFFECT)
        if all(rival.effects != likeliest.effects for rival in rivals):
            rivals.append(likeliest)
    if rivals:
        return _beside_rivals(evidence, chosen, rivals, pool, proven, weighed)
    akin = tuple(rivals_of(evidence, chosen, pool, akin=True))
    unlikely = weighed.least_of(chosen) < rules.likely
    if not akin and unlikely and likeliest is not None and same_class(chosen, likeliest):
        # Which effect of a family it is, its presence says.
        akin = (likeliest,)
    sure = max(weighed.least_of(chosen), weighed.among(chosen, akin)) >= rules.certain
    if sure or not akin:
        return Decision(Status.NAMED, chosen, akin, rest_of(evidence, chosen, weighed))
    several = (chosen, *akin)
    return _ambiguous(several, leading=max(several, key=weighed.least_of))


def _ambiguous(several: Sequence[Candidate], leading: Candidate) -> Decision:
    others = tuple(c for c in several if c is not leading)
    return Decision(Status.AMBIGUOUS, leading, others, Reason.RIVAL)


def _with_what_is_certain(weighed: Presence, chosen: Candidate, certain: float) -> Candidate:
    """Return the likeliest set with every certain effect that the chosen one lacks, if any does.

    A chosen candidate that is itself certain is returned as it is; otherwise it may stand for a
    further effect beside the certain ones.
    """
    others = weighed.sure(certain) - chosen.effects
    if not others or weighed.least_of(chosen) >= certain:
        return chosen
    return next((c for c in weighed.candidates if c.effects > others), chosen)


def _surest(weighed: Presence, chosen: Candidate | None, certain: float) -> Candidate | None:
    """Return the candidate with nearly all of the weight, if there is one.

    Otherwise it is the chosen candidate, if that is a single effect with a certain presence: larger
    sets that contain it, none of which is accepted, may hold part of its weight.
    """
    alone = weighed.surest(certain)
    if alone is not None or chosen is None or len(chosen.names) > 1:
        return alone
    return chosen if weighed.least_of(chosen) >= certain else None


def _beside_rivals(
    evidence: Evidence,
    chosen: Candidate,
    rivals: Sequence[Candidate],
    pool: Sequence[Candidate],
    proven: Sequence[Candidate],
    weighed: Presence,
) -> Decision:
    """Name what a larger set shares with its rivals, or the part of it that is certain.

    Otherwise several are left. What the evidence excludes does not lead where another one is
    closer to the record.
    """
    if len(chosen.names) > 1:
        shared = chosen.effects.intersection(*(rival.effects for rival in rivals))
        for candidate in proven:
            # If many second effects do as well, the shared one is certain, and the second one
            # stands for an error of its law.
            if (
                candidate.effects == shared
                and weighed.least_of(candidate) >= evidence.rules.likely
                and suffices(evidence, candidate, weighed)
                and not rivals_of(evidence, candidate, pool)
            ):
                rest = rest_of(evidence, candidate, weighed)
                return Decision(Status.NAMED, candidate, reason=rest)
        part = certain_part(evidence, pool, weighed)
        if part is not None:
            return Decision(Status.NAMED, part, reason=Reason.REMAINS, whole=False)
    leading = chosen
    if weighed.least_of(chosen) < 1.0 - evidence.rules.certain:
        closer = (rival for rival in rivals if rival.error <= chosen.error)
        leading = max((chosen, *closer), key=weighed.least_of)
    return _ambiguous((chosen, *rivals), leading)


def _stands_alone(
    evidence: Evidence, surest: Candidate, pool: Sequence[Candidate], weighed: Presence
) -> bool:
    """Return whether a candidate with nearly all of the weight is good enough to be named.

    It need not predict blocks left out better than its rivals: there may be few such blocks. The
    simulation alone must leave more than noise. Against a single effect, no other one may have
    nearly the same misfit, unless that other one predicts blocks left out much worse. A pair can
    overfit: no other pair may have nearly the same error, unless that other pair shares a family
    with it and predicts blocks left out worse. If two pairs without a common family fit equally
    well, neither is the explanation. A subset of its effects must leave room for the others.
    """
    rules, floor = evidence.rules, evidence.floor
    before, stated = evidence.nominal_error, evidence.stated_floor
    if before <= rules.clean * stated or not suffices(evidence, surest, weighed):
        return False
    if not each_adds(evidence, surest, pool):
        return False

    def stands_against(other: Candidate) -> bool:
        if other.effects < surest.effects:
            return not rules.leaves_room(other.rmse, before, floor)
        if len(other.names) != len(surest.names) or other.effects == surest.effects:
            return False
        if len(surest.names) > 1:
            if not rules.nearly(other.error, surest.error):
                return False
            predicts = evidence.held_out.rmse
            unlike = not families_of(other) & families_of(surest)
            return unlike or predicts(other.fit) <= predicts(surest.fit)
        if not rules.as_good(other.error, surest.error, evidence.noise_floor):
            return False
        predicted, rivalling = (evidence.held_out.residual(c.fit) for c in (surest, other))
        worse, low = beaten(predicted, rivalling, evidence.blocks, evidence.resampling)
        # With few blocks, resampling often omits the one that separates them.
        return low <= rules.needed_gain and worse <= np.log(rules.near)

    if any(stands_against(c) for c in pool if c.finished):
        return False
    # A drift or hum of a sensor is common: held-out blocks must show its course in time.
    of_readings = has_course_of_reading(surest.fit.extended)
    complete = before > rules.grow * stated and not rules.leaves_room(surest.rmse, before, stated)
    if complete and not of_readings:
        return borne_out(evidence, surest)
    return share_of(evidence, surest.fit).low >= rules.part


def _nothing_proven(evidence: Evidence) -> Decision:
    """Say whether a residual that no effect reduces is noise.

    It is not known to be coloured noise where the simulation has gone as far after it as its priors
    allow.
    """
    rules, problem, alone = evidence.rules, evidence.problem, evidence.nominal
    unpredictable = residual_model(problem, alone.residual).ratio > 1.0 - rules.margin
    if unpredictable and evidence.nominal_error <= rules.clean * evidence.stated_floor:
        return Decision(Status.NONE, None, reason=Reason.NOISE)
    if unpredictable and evidence.nominal_error <= rules.noise_like * evidence.stated_floor:
        return Decision(Status.NONE, None, reason=Reason.IRREDUCIBLE)
    coloured = not at_prior_bounds(alone) and is_coloured_noise(
        problem, alone.residual, evidence.blocks, rules.may_follow()
    )
    white = unpredictable and is_white(problem, alone.residual)
    if (coloured or white) and follows_no_force(problem, alone, rules.may_follow()):
        return Decision(Status.NONE, None, reason=Reason.COLOURED if coloured else Reason.UNEVEN)
    return Decision(Status.UNKNOWN, None, reason=Reason.NO_EFFECT)
