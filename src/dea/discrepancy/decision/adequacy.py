"""How much of the gap a candidate removes, and whether it leaves room for another effect."""

from collections.abc import Sequence

from dea.discrepancy.decision.decision import Reason
from dea.discrepancy.evidence.colour import is_coloured_noise
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.presence import Presence, Share, share_removed
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.problem import rmse
from dea.discrepancy.rules import misfit
from dea.discrepancy.search.candidates import Candidate


def explained(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether too little is left over for another effect to be hidden in it."""
    floor, rules = evidence.floor, evidence.rules
    if chosen.rmse <= rules.clean * floor:
        return True
    further = rules.leaves_room(chosen.rmse, evidence.nominal_error, floor)
    if further and weighed.wider_than(chosen) >= rules.certain:
        return False
    # Several laws together fit almost any residual, so that they must leave noise alone.
    if len(chosen.names) > 1 and chosen.rmse > rules.grow * floor:
        return False
    left, whole = misfit(chosen.rmse, floor), misfit(evidence.nominal_error, floor)
    if left > rules.misfit * whole:
        return leaves_coloured_noise(evidence, chosen, weighed)
    if left <= 0.5 * rules.misfit * whole:
        return True
    return residual_model(evidence.problem, chosen.fit.residual).ratio >= rules.predictable


def rest_of(evidence: Evidence, chosen: Candidate, weighed: Presence) -> Reason | None:
    """Return what an effect that is named leaves, if it is known as noise beyond the floor."""
    beyond = chosen.rmse > evidence.rules.clean * evidence.floor
    noise = beyond and leaves_coloured_noise(evidence, chosen, weighed)
    return Reason.COLOURED if noise else None


def leaves_coloured_noise(evidence: Evidence, chosen: Candidate, weighed: Presence) -> bool:
    """Return whether most of the gap is explained, and the rest is noise that follows nothing.

    What a further effect surely explains is no noise.
    """
    if share_of(evidence, chosen).low < evidence.rules.part:
        return False
    if weighed.wider_than(chosen) >= evidence.rules.certain:
        return False
    return is_coloured_noise(evidence.problem, chosen.fit.residual, evidence.blocks)


def without_noise(
    evidence: Evidence, chosen: Candidate, pool: Sequence[Candidate]
) -> Candidate | None:
    """Return an answer without the drift of its reading, if that is coloured noise.

    A drift of a sensor that is as small as its white noise is part of its noise. None where there
    is no drift beside other effects, where it is more than that in any record, or where others
    explain the record better without it.
    """
    rules, problem, extended = evidence.rules, evidence.problem, chosen.fit.extended
    kept = {extended.label(a) for a in extended.attached if not a.effect.drifts_reading}
    if not kept or kept == set(chosen.labels):
        return None
    as_large = (c for c in pool if c.finished and len(c.labels) == len(kept))
    part = min(as_large, key=lambda c: c.error, default=None)
    if part is None or set(part.labels) != kept:
        return None
    residual = part.fit.residual
    most = rules.noise_like * evidence.floor
    if any(rmse(residual[own], problem.seen[own]) > most for own in part.fit.records):
        return None
    if share_of(evidence, part).low < rules.part:
        return None
    return part if is_coloured_noise(problem, residual, evidence.blocks) else None


def share_of(evidence: Evidence, part: Candidate) -> Share:
    """Return the part of the simulation's misfit on held-out blocks that a candidate removes."""
    held_out = evidence.held_out
    before, after = held_out.residual(evidence.nominal), held_out.residual(part.fit)
    return share_removed(before, after, evidence.blocks, evidence.floor, evidence.rng)
