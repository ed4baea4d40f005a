"""A round of the search: every effect on top of one simulation, the best fitted to the end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from math import ceil

import numpy as np

from dea.discrepancy.budget import Budget
from dea.discrepancy.fitting.candidates import Candidate, judged
from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.fitting.parallel import Item, Result, in_parallel
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.search.hints import foreign_lines, jumps, lines
from dea.discrepancy.search.not_offered import NotOffered, Obstacle, never_tried, places
from dea.discrepancy.search.screening import (
    Base,
    Offer,
    first_steps,
    further_steps,
    promising,
    refine,
)
from dea.simulation import (
    Effect,
    Scales,
    measured_scales,
    with_fine_steps,
)

# These share out the time of a diagnosis; no measurement of their values is recorded.
# Fits of one effect, from different bases, that go beyond the screening.
_RUNNERS_UP = 2
# Effects that go on after the first steps, in the number of those that are fitted to the end. Of
# eight records, the first six after these steps were among the first eight of 22 before them, and
# the first four among the first five of eight.
_AHEAD = 1.5
# Leaders whose last steps have every column of the Jacobian computed anew; of second effects one.
_POLISHED = 2
# Part of the candidates that are fitted to the end where they are second effects: there is a round
# of these for each leading first one.
_SECOND = 2 / 3
# A short record affords more fits of a first effect than the budget's least number: so many samples
# are shared among them, and there are at most so many fits.
_SHORT, _MOST_KEPT = 24_000, 6


@dataclass(frozen=True)
class Round:
    """All candidates that extend one simulation by one effect, best first.

    ``skipped`` are the effects that never became a candidate.
    """

    before: Fit
    candidates: tuple[Candidate, ...] = field(default_factory=tuple)
    skipped: tuple[NotOffered, ...] = ()


def extend_by_each(
    problem: Problem,
    bases: Sequence[Fit],
    effects: Sequence[Effect],
    budget: Budget,
    workers: int,
) -> Round:
    """Fit each effect on top of a simulation: all from all their starts, the best to the end.

    ``bases`` are fits of that simulation to start from; the first is the one to beat.
    """
    made = _Extending(problem, bases, budget, workers)
    leaders, skipped = made.screened(effects)
    finished = made.finished(leaders[: made.count])
    candidates = [judged(problem, each) for each in finished]
    candidates += [judged(problem, fits[0], finished=False) for fits in leaders[made.count :]]
    candidates.sort(key=lambda c: c.error)
    return Round(bases[0], tuple(candidates), never_tried(dict.fromkeys(skipped), candidates))


@dataclass(frozen=True)
class _Extending:
    """A round in the making: what it extends, and what it spends on that."""

    problem: Problem
    bases: Sequence[Fit]
    budget: Budget
    workers: int

    @property
    def _before(self) -> Fit:
        return self.bases[0]

    @property
    def _first(self) -> bool:
        """Whether nothing is attached yet."""
        return not self._before.extended.attached

    @property
    def count(self) -> int:
        """Candidates that are fitted to the end."""
        return self.budget.finished if self._first else round(_SECOND * self.budget.finished)

    @property
    def _kept(self) -> int:
        """Fits of one effect that go on after the screening."""
        if not self._first:
            return self.budget.kept
        return int(np.clip(_SHORT // self.problem.size, self.budget.kept, _MOST_KEPT))

    def _error(self, fitted: Fit) -> float:
        return self.problem.seen_rmse(fitted.residual)

    def _each(
        self, attempt: Callable[[Item], Result], items: Sequence[Item], step: str
    ) -> list[Result]:
        extended = self._before.extended
        beside = " and ".join(map(extended.places.label, extended.attached)) or "the simulation"
        return in_parallel(attempt, items, self.workers, f"{step} beside {beside}")

    def screened(self, effects: Sequence[Effect]) -> tuple[list[list[Fit]], list[NotOffered]]:
        """Return the fits of each effect after a few steps, best first, and what has none."""
        problem, before = self.problem, self._before
        offers, skipped = _offers(problem, before, effects)
        prepared = [Base.of(problem, each) for each in self.bases]
        starts = self._each(
            lambda offer: promising(problem, prepared, offer, self._kept),
            offers,
            "starting points of each effect",
        )
        offered = [pair for pair in zip(offers, starts, strict=True) if pair[1]]
        without_start = [offer for offer, own in zip(offers, starts, strict=True) if not own]
        skipped += _refused(before, without_start, Obstacle.NO_START)
        if not self._first:
            offered = sorted(offered, key=lambda pair: pair[1][0].left)[: self.budget.offered]
        screened = self._each(
            lambda pair: first_steps(problem, prepared[0], *pair, self.budget.screening),
            offered,
            "first steps of each effect",
        )
        unstable = [offer for (offer, _), fits in zip(offered, screened, strict=True) if not fits]
        skipped += _refused(before, unstable, Obstacle.UNSTABLE)
        ahead = self._ranked(screened)
        count = ceil(_AHEAD * self.count)
        further = self._each(
            lambda fits: further_steps(problem, fits, self._kept, self.budget.screening),
            ahead[:count],
            "further steps of the effects ahead",
        )
        stable: dict[str, list[Fit]] = {}
        for fits in self._ranked([*further, *(fits[: self._kept] for fits in ahead[count:])]):
            # An effect may be offered upstream and downstream of another; the better place goes on.
            stable.setdefault(fits[0].extended.places.label(fits[0].extended.attached[-1]), fits)
        return list(stable.values()), skipped

    def _ranked(self, each: Sequence[list[Fit]]) -> list[list[Fit]]:
        """Return the fits of each effect that has any, the effect with the best fit first."""
        return sorted((fits for fits in each if fits), key=lambda fits: self._error(fits[0]))

    def finished(self, leaders: Sequence[Sequence[Fit]]) -> list[Fit]:
        """Return the leaders fitted: those near the best to the end, the first of them anew."""
        problem, budget = self.problem, self.budget
        ahead = self._each(
            lambda fits: min(
                (
                    refine(problem, each, budget.first_steps, tolerance=budget.tolerance)
                    for each in fits[:_RUNNERS_UP]
                ),
                key=self._error,
            ),
            leaders,
            "fits of the leading effects",
        )
        limit = budget.near * min(map(self._error, ahead), default=0.0)
        near = [each for each in ahead if self._error(each) <= limit]
        finished = self._each(
            lambda each: refine(
                problem,
                _with_fine_steps(problem, each),
                budget.last_steps,
                tolerance=budget.tolerance,
            ),
            near,
            "final fits of the leading effects",
        )
        finished.sort(key=self._error)
        polished = _POLISHED if self._first else 1
        finished[:polished] = self._each(
            lambda each: _polished(problem, each, budget),
            finished[:polished],
            "last fits of the best effects",
        )
        return finished + [each for each in ahead if self._error(each) > limit]


def _refused(before: Fit, offers: Sequence[Offer], reason: Obstacle) -> list[NotOffered]:
    return [NotOffered.at(before.extended, each.effect, each.place, reason) for each in offers]


def _polished(problem: Problem, fitted: Fit, budget: Budget) -> Fit:
    """Fit with every column anew, and from perturbed starts if much of the residual is left.

    Laws with corners give the cost kinks at which a fit can stop early. A second or third effect
    has been fitted from enough starts already.
    """
    best = fitted_again(problem, fitted, budget)
    own = fitted.extended.layout.of_laws
    count = budget.shakes if len(fitted.extended.attached) == 1 else 0
    for push in budget.shake_size * np.random.default_rng(0).standard_normal((count, own.size)):
        level = problem.white_level(best.residual)
        if problem.seen_rmse(best.residual) <= budget.shake_above * level:
            break
        shaken = replace(best, coordinates=best.coordinates + np.where(own, push, 0.0))
        best = min(best, fitted_again(problem, shaken, budget), key=lambda each: each.cost)
    return best


def with_shapes_anew(problem: Problem, fitted: Fit, budget: Budget) -> Fit:
    """Return a fit in which the parameters that shape the laws start from their prior means again.

    They may have adapted to an effect in the wrong place, or to the lack of another one.
    """
    shapes = fitted.extended.layout.shapes
    placed = fit(
        problem,
        fitted.extended,
        np.where(shapes, 0.0, fitted.coordinates),
        iterations=budget.first_steps,
        columns=Columns(held=shapes),
    )
    return fitted_again(problem, placed, budget)


def from_prior_means(problem: Problem, fitted: Fit, budget: Budget) -> Fit:
    """Return a fit from the same laws, with the simulation's parameters at their prior means.

    These may have moved far to make up for the effects, and a fit from there converges slowly.
    A further effect is better attached to the fit made before this one: in this fit the first
    effect, the best by itself, may have taken over part of what the further one explains.
    """
    start = np.where(fitted.extended.layout.of_laws, fitted.coordinates, 0.0)
    return fitted_again(problem, replace(fitted, coordinates=start), budget)


def fitted_again(problem: Problem, fitted: Fit, budget: Budget) -> Fit:
    """Return the fit that the last steps reach from the coordinates of another."""
    return fit(
        problem,
        fitted.extended,
        fitted.coordinates,
        iterations=budget.last_steps,
        tolerance=budget.tolerance,
    )


def _with_fine_steps(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit whose integration steps suit its effects, and not the simulation alone."""
    extended = with_fine_steps(
        fitted.extended,
        fitted.values,
        problem.u,
        problem.interval,
        problem.tolerance,
        problem.most_steps,
    )
    return replace(fitted, extended=extended)


def _offers(
    problem: Problem, before: Fit, effects: Sequence[Effect]
) -> tuple[list[Offer], list[NotOffered]]:
    """Return every effect at every port it can attach to and is not attached to yet.

    And those that cannot.
    """
    extended = before.extended
    residual = before.residual
    frequencies, foreign = lines(problem, residual), foreign_lines(problem, residual)
    instants = jumps(problem, residual)

    @cache
    def scales(at_input: int) -> Scales:
        return replace(
            measured_scales(extended, before.values, problem.uncertified, at_input=at_input),
            frequencies=frequencies,
            foreign_frequencies=foreign,
            jumps=instants,
        )

    there = {(a.effect.name, a.place) for a in extended.attached}
    on_input = {a.place for a in extended.attached if a.effect.shape_input}
    on_output = any(a.effect.shape_output for a in extended.attached)
    offers: list[Offer] = []
    skipped: list[NotOffered] = []
    for effect in effects:
        free, closed = places(problem, extended, effect)
        skipped += closed
        for place in free:
            if (effect.name, place) in there:
                continue
            meets = (effect.shape_input and place in on_input) or (
                effect.shape_output and on_output
            )
            own = scales(place if effect.on_input else 0)
            sides = (False, True) if meets else (False,)
            offers += [Offer(effect, own, place, upstream) for upstream in sides]
    return offers, skipped
