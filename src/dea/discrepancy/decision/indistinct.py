"""An effect that fits no better than another one of its class."""

from collections.abc import Sequence
from dataclasses import replace

from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.decision.rivals import same_class
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.candidates import Candidate


def left_open(
    decision: Decision, pool: Sequence[Candidate], weighed: Presence, rules: Rules
) -> Decision:
    """Make a single effect that is named ambiguous where others of its class fit as well.

    Those are finished and leave at most ``rules.alike`` times its residual. A law that is nearly
    right errs by as much, and needs more of its shape to follow the true one than a simpler law in
    the wrong place does, so that neither fit nor evidence tell them. The likeliest leads. A certain
    part of an answer stays named.
    """
    named = decision.chosen
    if decision.status is not Status.NAMED or not decision.whole or named is None:
        return decision
    if len(named.names) > 1:
        return decision
    others = {each.effects: each for each in decision.rivals}
    alike = [each for each in pool if _fits_as_well(each, named, rules)]
    if not alike:
        return decision
    for each in alike:
        others.setdefault(each.effects, each)
    several = (named, *others.values())
    leading = max(several, key=weighed.least_of)
    rest = tuple(each for each in several if each is not leading)
    return replace(
        decision, status=Status.AMBIGUOUS, chosen=leading, rivals=rest, reason=Reason.RIVAL
    )


def _fits_as_well(other: Candidate, named: Candidate, rules: Rules) -> bool:
    single = other.finished and len(other.names) == 1 and other.effects != named.effects
    return single and same_class(named, other) and other.rmse <= rules.alike * named.rmse
