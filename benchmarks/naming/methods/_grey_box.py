"""Grey-box selection by Akaike's criterion: the fits of a diagnosis without its evidence."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from benchmarks.naming.task import Answer, Task
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.search.rounds import Round, extend_by_each
from dea.discrepancy.search.starts import bases, fit_near_prior
from dea.simulation import catalogue


def aic(residual: np.ndarray, parameters: int) -> float:
    """Return Akaike's criterion of a least-squares fit with white noise of unknown variance."""
    return residual.size * float(np.log(np.mean(residual**2))) + 2.0 * (parameters + 1)


def selected(task: Task, most: int) -> Answer:
    """Name the effects, ``most`` of them at most, of the extension with the least criterion.

    Every effect is fitted jointly with the simulation's parameters to all of the seen part; each
    further one is fitted on top of the best extension so far.
    """
    problem, best = task.problem, task.nominal

    def criterion(fitted: Fit) -> float:
        return aic(fitted.residual[problem.seen], fitted.coordinates.size)

    first: Round = task.shared.once("singles", partial(_singles, task))
    for count in range(most):
        grown = _extended(task, [best]) if count else first
        found = min((c.fit for c in grown.candidates), key=criterion, default=best)
        if criterion(found) >= criterion(best):
            break
        best = found
    names = frozenset(a.effect.name for a in best.extended.attached)
    return Answer("named" if names else "none", task.ahead(best), names)


def _singles(task: Task) -> Round:
    near = fit_near_prior(task.problem, task.nominal)
    return _extended(task, bases(task.problem, task.nominal, near, task.rng))


def _extended(task: Task, starts: Sequence[Fit]) -> Round:
    problem = task.problem
    budget = task.settings.budget.of(problem.recorded_samples, problem.oversampled)
    return extend_by_each(problem, starts, list(catalogue().values()), budget, workers=1)
