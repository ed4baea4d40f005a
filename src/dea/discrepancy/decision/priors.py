"""A device that the simulation's own priors exclude, of which nothing else need be missing."""

from dataclasses import replace

import numpy as np

from dea.discrepancy.decision.decision import Decision, Reason, Status
from dea.discrepancy.evidence.certificate import certify
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fit import Fit, at_bounds, beyond_priors, fit
from dea.discrepancy.parallel import in_parallel

# Factor on the declared spreads here, and the steps of such a fit. The values were chosen.
_WIDER, _ITERATIONS = 4.0, 40


def with_priors_checked(decision: Decision, evidence: Evidence, workers: int) -> Decision:
    """Return ``unknown`` where the simulation alone explains the record beyond its priors.

    Only parameters that are at their bounds without an effect call for that. An effect may then
    stand for them, and the record does not tell which of the two is wrong. Where the answer leaves
    more than noise, the simulation alone must leave hardly more than it.
    """
    if decision.status is Status.NONE or not beyond_priors(evidence.nominal):
        return decision
    freed = _fit_freed(evidence, workers)
    rules, floor = evidence.rules, evidence.stated_floor
    best = 0.0 if decision.answer is None else decision.answer.rmse
    left = evidence.problem.seen_rmse(freed.residual)
    certified = certify(evidence.problem, evidence.nominal, freed).after
    explained = left <= rules.clean * floor or rules.nearly(left, best)
    if not explained or certified > rules.poor * max(floor, best):
        return decision
    return Decision(Status.UNKNOWN, None, reason=Reason.PRIORS, freed=freed)


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
        freed.coordinates(nominal.extended.values(each))
        for each in (own, 0.0 * own, np.where(there, 2.0 * own, own))
    ]
    fits = in_parallel(
        lambda start: fit(problem, freed, start, iterations=_ITERATIONS), starts, workers
    )
    return min(fits, key=lambda each: each.cost)
