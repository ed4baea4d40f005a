"""What samples and records that chose nothing say of a decision."""

from collections.abc import Mapping

import numpy as np

from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.evidence.certificate import Certified, certify, contradicting
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import rmse
from dea.discrepancy.rules import misfit

_CERTIFIED = "certified samples"


def confirmed(
    decision: Decision,
    evidence: Evidence,
    final: Fit,
    left_out: Mapping[str, Certified],
    tested: Mapping[str, Certified],
    dated: bool = False,
) -> Decision:
    """Withdraw what the certified samples contradict, or other records of the device.

    They choose nothing. ``final`` is the last fit of the answer, or the simulation alone; certified
    samples that ``dated`` an event must leave about as little as the seen ones. ``left_out`` are
    the errors on the records of a joint diagnosis, each left out in turn; ``tested`` are those on
    test records. Neither contradicts ``none``, which says what the diagnosed records could show.
    The certified samples contradict ``none`` only if they leave much more than the others, since
    the level of coloured noise varies along a record.
    """
    problem, nominal, rules = evidence.problem, evidence.nominal, evidence.rules
    answer = decision.answer
    if answer is None:
        level = max(evidence.floor, evidence.nominal_error)
        left = rmse(nominal.residual, problem.certify)
        if decision.status is Status.NONE and left > rules.noise_like * level:
            return Decision(Status.UNKNOWN, None, reason=Reason.ONLY_CERTIFIED)
        return decision
    noise = decision.noise(rules, evidence.floor)
    block = certify(problem, nominal, final)
    most = max(noise, rules.near * answer.rmse) if dated else np.inf
    if block.after > most or _falls_short(evidence, answer.rmse, block):
        contradicted = {_CERTIFIED: block}
        return Decision(
            Status.UNKNOWN, answer, reason=Reason.CONTRADICTED, contradicted=contradicted
        )
    for reason, found, allowed in (
        (Reason.CONTRADICTED, {_CERTIFIED: block}, noise),
        (Reason.OF_ONE_RECORD, left_out, 0.0),
        (Reason.CONTRADICTED_ELSEWHERE, tested, noise),
    ):
        against = contradicting(found, allowed)
        if against:
            return Decision(Status.UNKNOWN, answer, reason=reason, contradicted=against)
    return decision


def _falls_short(evidence: Evidence, left: float, block: Certified) -> bool:
    """Return whether a certified gap as large as elsewhere is reduced far less than there.

    ``left`` is the error that the answer leaves elsewhere.
    """
    rules, floor = evidence.rules, evidence.floor
    before, after = misfit(block.before, floor), misfit(block.after, floor)
    elsewhere = misfit(evidence.nominal_error, floor)
    removed = (elsewhere - misfit(left, floor)) * before
    return (
        before > rules.certified * elsewhere
        and (before - after) * elsewhere < rules.upheld * removed
    )
