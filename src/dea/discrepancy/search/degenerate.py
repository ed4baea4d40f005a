"""Candidates that are not what their names say.

Either they fit as well with their essential parameter at its bound, or the limit of the reading
that they hold is not reached and a curve does as well.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

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
    leading = [c for c in finished if c.error <= limit]
    doubtful = [c for c in leading if any(a.effect.essential for a in c.fit.extended.attached)]
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
    leading = [c for c in leading if id(c) not in fallen]
    curves = [(c, found) for c in leading if (found := _on_output(c, Family.CURVE))]
    for c in leading:
        limiting = _on_output(c, Family.LIMIT)
        if limiting is None:
            continue
        alike = (d for d, curve in curves if curve.beside == limiting.beside)
        as_good = any(rules.as_good(d.rmse, c.rmse, floor) for d in alike)
        if as_good and _bends_gently(problem, c.fit, limiting.place):
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


class _OnOutput(NamedTuple):
    """Which of the effects of a candidate is on the output path, and those beside it."""

    place: int
    beside: frozenset[str]


def _on_output(candidate: Candidate, family: Family) -> _OnOutput | None:
    """Return the first effect of a family on the output path, if there is any."""
    labels = candidate.labels
    for index, each in enumerate(candidate.fit.extended.attached):
        if each.effect.port is Port.OUTPUT and each.effect.family is family:
            return _OnOutput(index, frozenset(labels[:index] + labels[index + 1 :]))
    return None


def _bends_gently(problem: Problem, found: Fit, index: int) -> bool:
    """Return whether the reading follows at both ends of its range nearly as in between."""
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
