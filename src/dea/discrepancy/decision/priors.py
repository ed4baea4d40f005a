"""A device that the simulation's own priors exclude, so that no effect is needed to explain it."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.evidence.certificate import certify, certify_elsewhere, contradicting
from dea.discrepancy.evidence.colour import leaves_coloured_noise
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fitting.fit import Fit, at_bounds, at_prior_bounds, fit, outside_priors
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Samples

# Factor on the declared spreads here, and the steps of such a fit. The values were chosen.
_WIDER, _ITERATIONS = 4.0, 40


def with_priors_checked(
    decision: Decision, evidence: Evidence, others: Mapping[str, Samples], workers: int
) -> Decision:
    """Return ``unknown`` where the simulation alone explains the record beyond its priors.

    Only parameters that are at their bounds without an effect call for that. An effect may then
    stand for them, and the record does not tell which of the two is wrong. Where the answer leaves
    more than noise, the simulation alone must leave hardly more than it.
    """
    if decision.status is Status.NONE or not at_prior_bounds(evidence.nominal):
        return decision
    freed = _fit_freed(evidence, workers)
    outside = outside_priors(freed, evidence.nominal.extended).any()
    if not outside or not _explains(decision, evidence, others, freed):
        return decision
    return Decision(Status.UNKNOWN, None, reason=Reason.PRIORS, freed=freed)


def _explains(
    decision: Decision, evidence: Evidence, others: Mapping[str, Samples], freed: Fit
) -> bool:
    """Return whether a fit explains the record as well as the answer, and other samples too.

    Without an answer, coloured noise may be left. The certified samples and the test records must
    not contradict it.
    """
    problem, rules, floor = evidence.problem, evidence.rules, evidence.stated_floor
    left = problem.seen_rmse(freed.residual)
    level = floor if decision.answer is None else max(floor, decision.answer.rmse)
    if decision.answer is None and leaves_coloured_noise(
        problem, freed, evidence.blocks, rules.may_follow()
    ):
        level = max(floor, left)
    if left > rules.clean * floor and not rules.nearly(left, level):
        return False
    certified = certify(problem, evidence.nominal, freed).after
    tested = certify_elsewhere(others, evidence.nominal, freed)
    return certified <= rules.poor * level and not contradicting(tested, rules.clean * level)


def _fit_freed(evidence: Evidence, workers: int) -> Fit:
    """Return the best fit of the simulation alone with wider priors of its own parameters.

    It starts from the fit with the declared ones, from the prior means, and from where the
    parameters at their bounds are twice as far.
    """
    problem, nominal = evidence.problem, evidence.nominal
    own, there = nominal.coordinates, at_bounds(nominal.extended, nominal.coordinates)
    declared = nominal.extended.simulation
    wider = [replace(each, spread=_WIDER * each.spread) for each in declared.parameters]
    freed = replace(nominal.extended, simulation=replace(declared, parameters=tuple(wider)))
    starts = [
        freed.layout.coordinates(nominal.extended.layout.values(each))
        for each in (own, 0.0 * own, np.where(there, 2.0 * own, own))
    ]
    fits = in_parallel(
        lambda start: fit(problem, freed, start, iterations=_ITERATIONS), starts, workers
    )
    return min(fits, key=lambda each: each.cost)
