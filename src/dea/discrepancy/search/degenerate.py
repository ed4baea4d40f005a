"""Candidates that are not what their names say.

They fit as well with an essential parameter at its bound, or with an event at the start of the
record; or a limit that they hold is not reached: one of the command, or one of the reading where a
curve does as well.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dea.discrepancy.fitting.candidates import Candidate, best_of_each_set, judged
from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.rounds import Round
from dea.simulation import Family, Port, law_courses
from dea.warm_up import LONGEST_WARM_UP

# Steps of the fit with the essential parameter at its bound. A threshold of half the range becomes
# a power law there, whose fit takes about twelve.
_STEPS = 20
# Slope at both ends of what is limited, as a part of the largest, above which no limit is reached,
# and the pieces of its range that it is taken from.
_GENTLE, _PIECES = 0.6, 20


def unfinish_degenerate(
    problem: Problem, rounds: Sequence[Round], rules: Rules, noise_floor: float, workers: int
) -> list[Round]:
    """Return the rounds with such candidates, of the leading ones, marked as unfinished.

    Each law with an essential parameter (:class:`dea.simulation.Effect`) is fitted again with it at
    that bound. A candidate that explains the record as well there, or less by no more than its
    greater freedom is charged for, counts as unfinished, and so does one of an event that explains
    as much from the start of the record on. Those that lead once these have fallen are tested, too.
    """
    candidates = [c for each in rounds for c in each.candidates]
    tested: set[int] = set()
    fallen: set[int] = set()
    while True:
        leading = _leading([c for c in candidates if id(c) not in fallen], rules)
        new = [c for c in leading if id(c) not in tested]
        degenerate = in_parallel(
            lambda c: _is_degenerate(problem, c, rules, noise_floor),
            new,
            workers,
            "leading effects at their limits",
        )
        tested.update(map(id, new))
        found = [c for c, falls in zip(new, degenerate, strict=True) if falls]
        # Only when no leading candidate is degenerate: until then ``leading`` may still change.
        found = found or _gentle_limits(problem, leading, rules, noise_floor)
        if not found:
            break
        fallen.update(map(id, found))
    return [
        replace(
            each,
            candidates=tuple(
                replace(c, finished=False) if id(c) in fallen else c for c in each.candidates
            ),
        )
        for each in rounds
    ]


def _leading(candidates: Sequence[Candidate], rules: Rules) -> list[Candidate]:
    """Return those fitted to the end whose error is near the least, the best of each set."""
    finished = [c for c in candidates if c.finished]
    limit = rules.near * min((c.error for c in finished), default=0.0)
    return [c for c in best_of_each_set(finished) if c.error <= limit]


def _gentle_limits(
    problem: Problem, leading: Sequence[Candidate], rules: Rules, noise_floor: float
) -> list[Candidate]:
    """Return those with a limit that is not reached: a reading's where a curve does as well.

    The catalogue has no curve of the command, so that no competing explanation is asked for.
    """
    curves = [(c, found) for c in leading if (found := _on_path(c, Port.OUTPUT, Family.CURVE))]

    def is_gentle(c: Candidate) -> bool:
        command = _on_path(c, Port.INPUT, Family.LIMIT)
        if command is not None and _bends_gently(problem, c.fit, command.place):
            return True
        limiting = _on_path(c, Port.OUTPUT, Family.LIMIT)
        if limiting is None:
            return False
        alike = (d for d, curve in curves if curve.beside == limiting.beside)
        as_good = any(rules.as_good(d.rmse, c.rmse, noise_floor) for d in alike)
        return as_good and _bends_gently(problem, c.fit, limiting.place)

    return [c for c in leading if is_gentle(c)]


class _OnPath(NamedTuple):
    """Which of the effects of a candidate is on a signal's path, and those beside it."""

    place: int
    beside: frozenset[str]


def _on_path(candidate: Candidate, port: Port, family: Family) -> _OnPath | None:
    """Return the first effect of a family on the path of the input or output, if there is any."""
    labels = candidate.labels
    for index, each in enumerate(candidate.fit.extended.attached):
        if each.effect.port is port and each.effect.family is family:
            return _OnPath(index, frozenset(labels[:index] + labels[index + 1 :]))
    return None


def _bends_gently(problem: Problem, found: Fit, index: int) -> bool:
    """Return whether a signal is followed at both ends of its range nearly as in between."""
    course = law_courses(found.extended, found.values, problem.u, problem.interval)[index]
    if course is None:
        return False
    order = np.argsort(course.along.values)
    before, after = course.along.values[order], course.value.values[order]
    grid = np.linspace(before[0], before[-1], _PIECES + 1)
    slopes = np.diff(np.interp(grid, before, after))
    return bool(min(slopes[0], slopes[-1]) > _GENTLE * slopes.max())


def _is_degenerate(
    problem: Problem, candidate: Candidate, rules: Rules, noise_floor: float
) -> bool:
    """Return whether a law explains as much without its essential parameter, or its event."""
    for index, attached in enumerate(candidate.fit.extended.attached):
        if attached.effect.essential:
            limit = judged(problem, _without_essential(problem, candidate.fit, index))
            if _explains_as_much(limit, candidate, rules, noise_floor):
                return True
    return _is_from_the_start(problem, candidate, rules, noise_floor)


def _is_from_the_start(
    problem: Problem, candidate: Candidate, rules: Rules, noise_floor: float
) -> bool:
    """Return whether an event explains as much where it happens as soon as it can.

    What a device has done from the start is no event. Of several records all events are moved. One
    in what may be the warm-up of a record need not explain as much there: a law that acts from the
    start on may be poorer than what an event adds in the state at the start.
    """
    extended = candidate.fit.extended
    instants = extended.layout.instants
    if not instants.any():
        return False
    soonest = np.where(instants, extended.layout.bounds[0], candidate.fit.coordinates)
    earliest, own = (
        extended.layout.values(soonest),
        extended.layout.values(candidate.fit.coordinates),
    )
    moved = problem.seen_rmse(problem.residual(extended, earliest))
    # Most events have a date, and are far off without it.
    if not moved <= rules.near * candidate.rmse:
        return False
    shortest = min(each.stop - each.start for each in problem.records) * problem.interval
    if ((own - earliest)[extended.layout.free[instants]] < LONGEST_WARM_UP * shortest).all():
        return True
    # How long it took, or was held, stays: else it could end where the event began.
    held = Columns(held=extended.layout.events)
    again = fit(problem, extended, soonest, iterations=_STEPS, columns=held)
    return _explains_as_much(judged(problem, again), candidate, rules, noise_floor)


def _explains_as_much(
    limit: Candidate, candidate: Candidate, rules: Rules, noise_floor: float
) -> bool:
    """Return whether a candidate at its limit explains as much, its greater freedom charged."""
    return limit.error <= candidate.error or rules.as_good(limit.rmse, candidate.rmse, noise_floor)


def _without_essential(problem: Problem, found: Fit, index: int) -> Fit:
    """Return a fit in which the law of that number is the one without its essential parameter.

    Where the simulation runs away with what else was found, the law starts from its prior means:
    without its threshold an input may drive a film beyond its pull-in.
    """
    attached = list(found.extended.attached)
    law = attached[index] = replace(attached[index], effect=attached[index].effect.at_limit())
    limit = replace(found.extended, attached=tuple(attached))
    own = limit.layout.effect_slices[index]
    columns = Columns(slow=int(np.sum(limit.layout.free < own.start)))
    start = limit.layout.coordinates(found.values)
    again = fit(problem, limit, start, iterations=_STEPS, columns=columns)
    if not again.stable:
        values = found.values.copy()
        values[own] = [parameter.nominal for parameter in law.parameters]
        again = fit(problem, limit, limit.layout.coordinates(values), iterations=_STEPS)
    return again
