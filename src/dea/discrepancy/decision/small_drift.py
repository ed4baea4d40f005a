"""A drift of the reading that is as small as the white noise of the sensor."""

from collections.abc import Sequence

from dea.discrepancy.decision.adequacy import beside_noise
from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.decision.rivals import rivals_of
from dea.discrepancy.evidence.colour import leaves_coloured_noise
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import rmse


def without_small_drift(
    decision: Decision, evidence: Evidence, pool: Sequence[Candidate]
) -> Decision:
    """Leave the drift of the reading out of a whole answer, if it is coloured noise.

    It is kept if more than ``noise_like`` floors remain without it in any record, or if another set
    of as many effects has a smaller error. A drift that is all of the answer becomes ``none``.
    """
    if decision.status is not Status.NAMED or decision.chosen is None or not decision.whole:
        return decision
    if all(a.effect.drifts_reading for a in decision.chosen.fit.extended.attached):
        alone, blocks = evidence.nominal, evidence.blocks
        if _small(evidence, alone) and leaves_coloured_noise(
            evidence.problem, alone, blocks, evidence.rules.may_follow()
        ):
            return Decision(Status.NONE, None, reason=Reason.COLOURED)
        return decision
    part = _without_drift(decision.chosen, pool)
    if part is None or not _small(evidence, part.fit) or not beside_noise(evidence, part):
        return decision
    akin = tuple(rivals_of(evidence, part, pool, akin=True))
    return Decision(Status.NAMED, part, akin, Reason.COLOURED)


def _small(evidence: Evidence, fitted: Fit) -> bool:
    """Return whether a fit leaves little more than the noise floor in every record."""
    residual, seen = fitted.residual, evidence.problem.seen
    most = evidence.rules.noise_like * evidence.stated_floor
    return all(rmse(residual[own], seen[own]) <= most for own in fitted.records)


def _without_drift(chosen: Candidate, pool: Sequence[Candidate]) -> Candidate | None:
    """Return the other effects alone, if there is a drift and no others as many are better."""
    extended = chosen.fit.extended
    kept = {extended.places.label(a) for a in extended.attached if not a.effect.drifts_reading}
    if kept == set(chosen.labels):
        return None
    as_many = (c for c in pool if c.finished and len(c.labels) == len(kept))
    best = min(as_many, key=lambda c: c.error, default=None)
    return best if best is not None and set(best.labels) == kept else None
