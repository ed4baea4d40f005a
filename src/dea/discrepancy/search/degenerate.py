"""Candidates that explain the record as well where their law is no longer the effect named."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dea.discrepancy.fit import Columns, fit
from dea.discrepancy.parallel import in_parallel
from dea.discrepancy.problem import Problem
from dea.discrepancy.rules import Rules
from dea.discrepancy.search.candidates import Candidate
from dea.discrepancy.search.rounds import Round

# Steps of the fit with the essential parameter at its bound.
_STEPS = 8


def unfinish_degenerate(
    problem: Problem, rounds: Sequence[Round], rules: Rules, floor: float, workers: int
) -> list[Round]:
    """Return rounds in which no leading candidate bears the name of an effect for nothing.

    A law with an essential parameter (:class:`dea.simulation.Effect`) is fitted again with it at
    its lower bound. A candidate that explains the record as well there counts as unfinished.
    """
    finished = [c for each in rounds for c in each.candidates if c.finished]
    limit = rules.near * min((c.error for c in finished), default=0.0)
    doubtful = [(c, held) for c in finished if c.error <= limit and (held := _essential(c)).any()]
    errors = in_parallel(
        lambda pair: _error_at_limit(problem, *pair),
        doubtful,
        workers,
        "leading effects at their limits",
    )
    fallen = {
        id(c)
        for (c, _), error in zip(doubtful, errors, strict=True)
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


def _essential(candidate: Candidate) -> np.ndarray:
    """Return which coordinates are essential to the names of a candidate's effects, (k,) bool."""
    extended = candidate.fit.extended
    essential = [
        part.start + place
        for attached, part in zip(extended.attached, extended.effect_slices, strict=True)
        for place, parameter in enumerate(attached.parameters)
        if parameter.name == attached.effect.essential
    ]
    return np.isin(extended.free, essential)


def _error_at_limit(problem: Problem, candidate: Candidate, held: np.ndarray) -> float:
    low, _ = candidate.fit.extended.bounds
    start = np.where(held, low, candidate.fit.coordinates)
    again = fit(
        problem, candidate.fit.extended, start, iterations=_STEPS, columns=Columns(held=held)
    )
    return problem.seen_rmse(again.residual)
