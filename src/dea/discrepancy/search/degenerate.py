"""Candidates that fit as well with their essential parameter at its bound."""

from collections.abc import Sequence
from dataclasses import replace

from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.parallel import in_parallel
from dea.discrepancy.problem import Problem
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.rounds import Round

# Steps of the fit with the essential parameter at its bound.
_STEPS = 8


def unfinish_degenerate(
    problem: Problem, rounds: Sequence[Round], rules: Rules, floor: float, workers: int
) -> list[Round]:
    """Return the rounds with such leading candidates marked as unfinished.

    A law with an essential parameter (:class:`dea.simulation.Effect`) is fitted again with it at
    its lower bound. A candidate that explains the record as well there counts as unfinished.
    """
    finished = [c for each in rounds for c in each.candidates if c.finished]
    limit = rules.near * min((c.error for c in finished), default=0.0)
    doubtful = [
        c
        for c in finished
        if c.error <= limit and any(a.effect.essential for a in c.fit.extended.attached)
    ]
    errors = in_parallel(
        lambda c: _error_at_limit(problem, c.fit),
        doubtful,
        workers,
        "leading effects at their limits",
    )
    fallen = {
        id(c)
        for c, error in zip(doubtful, errors, strict=True)
        if rules.as_good(error, c.rmse, floor)
    }
    return [
        replace(
            each,
            candidates=tuple(
                replace(c, finished=False) if id(c) in fallen else c for c in each.candidates
            ),
        )
        for each in rounds
    ]


def _error_at_limit(problem: Problem, found: Fit) -> float:
    """Return what is left where each law is the one without its essential parameter."""
    extended = found.extended
    attached = tuple(replace(each, effect=each.effect.at_limit()) for each in extended.attached)
    limit = replace(extended, attached=attached)
    again = fit(problem, limit, limit.coordinates(found.values), iterations=_STEPS)
    return problem.seen_rmse(again.residual)
