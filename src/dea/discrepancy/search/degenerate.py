"""Candidates that are not what their names say.

Either they fit as well with their essential parameter at its bound, or the limit of the reading
that they hold is not reached and a curve does as well.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.parallel import in_parallel
from dea.discrepancy.problem import Problem
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.candidates import Candidate
from dea.discrepancy.search.rounds import Round
from dea.simulation import Family, Port, law_courses

# Steps of the fit with the essential parameter at its bound.
_STEPS = 8
# Slope at both ends of the readings, as a part of the largest, above which no limit is reached, and
# the pieces of their range that it is taken from.
_GENTLE, _PIECES = 0.6, 20


def unfinish_degenerate(
    problem: Problem, rounds: Sequence[Round], rules: Rules, floor: float, workers: int
) -> list[Round]:
    """Return the rounds with such candidates, of the leading ones, marked as unfinished.

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
    leading = [c for c in finished if c.error <= limit and id(c) not in fallen]
    curves = [c for c in leading if _on_output(c, Family.CURVE) is not None]
    for c in leading:
        others = _beside(c, Family.LIMIT)
        alike = (d for d in curves if others is not None and _beside(d) == others)
        if any(rules.as_good(d.rmse, c.rmse, floor) for d in alike) and _bends_gently(problem, c):
            fallen.add(id(c))
    return [
        replace(
            each,
            candidates=tuple(
                replace(c, finished=False) if id(c) in fallen else c for c in each.candidates
            ),
        )
        for each in rounds
    ]


def _on_output(candidate: Candidate, family: Family) -> int | None:
    """Return which of the attached effects is of a family on the output path, if any is."""
    for index, each in enumerate(candidate.fit.extended.attached):
        if each.effect.port is Port.OUTPUT and each.effect.family is family:
            return index
    return None


def _beside(candidate: Candidate, family: Family = Family.CURVE) -> frozenset[str] | None:
    """Return the other effects of a candidate with one of a family on the output path."""
    index = _on_output(candidate, family)
    if index is None:
        return None
    return frozenset(label for k, label in enumerate(candidate.labels) if k != index)


def _bends_gently(problem: Problem, candidate: Candidate) -> bool:
    """Return whether the reading follows at both ends of its range nearly as in between."""
    found, index = candidate.fit, _on_output(candidate, Family.LIMIT)
    if index is None:
        return False
    course = law_courses(found.extended, found.values, problem.u, problem.interval)[index]
    if course is None:
        return False
    order = np.argsort(course.along.values)
    before, after = course.along.values[order], course.value.values[order]
    grid = np.linspace(before[0], before[-1], _PIECES + 1)
    slopes = np.diff(np.interp(grid, before, after))
    return bool(min(slopes[0], slopes[-1]) > _GENTLE * slopes.max())


def _error_at_limit(problem: Problem, found: Fit) -> float:
    """Return what is left where each law is the one without its essential parameter."""
    extended = found.extended
    attached = tuple(replace(each, effect=each.effect.at_limit()) for each in extended.attached)
    limit = replace(extended, attached=attached)
    again = fit(problem, limit, limit.coordinates(found.values), iterations=_STEPS)
    return problem.seen_rmse(again.residual)
