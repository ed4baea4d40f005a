"""How much of the gap a candidate removes, and whether it leaves room for another effect."""

from dea.discrepancy.decision.decision import Reason
from dea.discrepancy.evidence.certificate import transferable
from dea.discrepancy.evidence.colour import leaves_coloured_noise
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.presence import Presence, Share, share_removed
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.rules import misfit


def suffices(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether too little is left over for another effect to be hidden in it."""
    floor, stated, rules = evidence.floor, evidence.stated_floor, evidence.rules
    if chosen.rmse <= rules.clean * stated:
        return True
    further = rules.leaves_room(chosen.rmse, evidence.nominal_error, floor)
    if further and weighed.wider_than(chosen) >= rules.certain:
        return False
    # Several laws together fit almost any residual: what they leave must be noise.
    if len(chosen.names) > 1 and chosen.rmse > rules.grow * stated:
        certain = weighed.least_of(chosen) >= rules.certain
        return certain and leaves_only_noise(evidence, chosen, weighed)
    left, whole = misfit(chosen.rmse, floor), misfit(evidence.nominal_error, floor)
    if left > rules.misfit * whole:
        return leaves_only_noise(evidence, chosen, weighed)
    if left <= 0.5 * rules.misfit * whole:
        return True
    return residual_model(evidence.problem, chosen.fit.residual).ratio >= rules.predictable


def rest_of(evidence: Evidence, chosen: Candidate, weighed: Presence) -> Reason | None:
    """Return what an effect that is named leaves, if it is known as noise beyond the floor."""
    beyond = chosen.rmse > evidence.rules.clean * evidence.stated_floor
    noise = beyond and leaves_only_noise(evidence, chosen, weighed)
    return Reason.COLOURED if noise else None


def leaves_only_noise(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether most of the gap is explained, and the rest is noise that follows nothing.

    It is not noise if explanations with a further effect are certain.
    """
    return beside_noise(evidence, chosen) and weighed.wider_than(chosen) < evidence.rules.certain


def beside_noise(evidence: Evidence, part: Candidate) -> bool:
    """Return whether a candidate explains most of the gap, and leaves what looks like noise."""
    if share_of(evidence, part.fit).low < evidence.rules.part:
        return False
    most = evidence.rules.may_follow(len(part.names))
    return leaves_coloured_noise(evidence.problem, part.fit, evidence.blocks, most)


def borne_out(evidence: Evidence, candidate: Candidate) -> bool:
    """Return whether a candidate removes most of the gap on blocks left out, too.

    A course in time is extrapolated at the ends of the record, and where it bends within a block;
    that says nothing against it.
    """
    if not transferable(candidate.fit.extended):
        return True
    return share_of(evidence, candidate.fit).value >= evidence.rules.part


def share_of(evidence: Evidence, extended: Fit) -> Share:
    """Return the part of the simulation's misfit on held-out blocks that an extension removes."""
    held_out = evidence.held_out
    before, after = held_out.residual(evidence.nominal, extended), held_out.residual(extended)
    return share_removed(before, after, evidence.blocks, evidence.floor, evidence.resampling)
