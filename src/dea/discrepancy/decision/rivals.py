"""The candidates that explain a record as well as another one."""

from collections.abc import Sequence

from dea.discrepancy.evidence.bootstrap import beaten
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fitting.candidates import Candidate


def same_class(first: Candidate, second: Candidate) -> bool:
    """Return whether the effects of two candidates are of the same families, one by one.

    Such effects form one class: a record hardly distinguishes them, or not at all.
    """
    own, other = (
        sorted(a.effect.family for a in each.fit.extended.attached) for each in (first, second)
    )
    return own == other


def rivals_of(
    evidence: Evidence, chosen: Candidate, pool: Sequence[Candidate], akin: bool = False
) -> list[Candidate]:
    """Return the candidates that explain the record as well: of another class, or of the same.

    Those with a similar error are compared with it on held-out residuals, since of two laws the
    more flexible one fits better the blocks that it has seen. Of several laws each is
    fitted to the errors of the others, so that a set of another class with nearly their error is a
    rival whatever it predicts.
    """
    held_out, rules = evidence.held_out, evidence.rules
    several = len(chosen.names) > 1 and not akin
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
        _, low = beaten(*residuals, evidence.blocks, evidence.resampling)
        as_good = rules.as_good(other.error, chosen.error, evidence.noise_floor)
        if low <= 0 or as_good or (several and rules.nearly(other.error, chosen.error)):
            rivals.append(other)
    return rivals
