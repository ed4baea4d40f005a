"""Candidates: fitted extensions of the simulation, ranked by how well they explain the record."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import prod

import numpy as np

from dea.discrepancy.fitting.fit import CLOSE, Fit, at_bounds
from dea.discrepancy.problem.problem import Problem

EffectSet = frozenset[str]


@dataclass(frozen=True)
class Candidate:
    """A fitted extension of the simulation, and how well it explains the record.

    Parameters
    ----------
    rmse
        RMS residual over all samples seen.
    error
        The same with a charge for its freedom, to rank by.
    freedom
        Effective number of its parameters: what the record, and not their prior, determines.
    finished
        Whether it was fitted to the end and may be named; otherwise it was only screened, or fits
        as well with its essential parameter at its bound.
    """

    fit: Fit
    rmse: float
    error: float
    freedom: float
    finished: bool = True

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, in the order in which they were attached.

        Of several inputs with the one that each acts on: elsewhere it is another effect.
        """
        return tuple(self.fit.extended.places.name_of(a) for a in self.fit.extended.attached)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The same with the force port of each where the simulation has several."""
        return tuple(self.fit.extended.places.label(a) for a in self.fit.extended.attached)

    @property
    def places(self) -> int:
        """In how many ways its effects could be attached to the force ports of the simulation."""
        extended = self.fit.extended
        forces = (a.effect for a in extended.attached if a.effect.force is not None)
        return prod(map(extended.places.number_for, forces))

    @cached_property
    def at_bounds(self) -> tuple[str, ...]:
        """Parameters of the effects that the record would have beyond their bounds.

        Those that only shape a law, or belong to the start, do not count: many laws have bounds at
        which one part of them vanishes. Nor does a parameter whose prior mean is its bound, if
        another one of the law has left its prior mean.
        """
        extended = self.fit.extended
        own = ~extended.layout.shapes & ~extended.layout.at_start
        found = self.fit.coordinates
        near = at_bounds(extended, found)
        moved = np.abs(found) > CLOSE
        counted: list[int] = []
        for part in extended.layout.effect_slices:
            of_law = own & (extended.layout.free >= part.start) & (extended.layout.free < part.stop)
            there = (of_law & moved).any()
            counted += extended.layout.free[of_law & near & (moved | ~there)].tolist()
        return tuple(extended.layout.names[i] for i in counted)

    @cached_property
    def counted(self) -> tuple[str, ...]:
        """The names, one that is there before marked as such: a stop may act at two places."""
        return tuple(
            name + " again" * self.names[:i].count(name) for i, name in enumerate(self.names)
        )

    @cached_property
    def effects(self) -> EffectSet:
        """The effect set, :attr:`counted`, whatever the order and the force ports."""
        return frozenset(self.counted)


def judged(problem: Problem, fit: Fit, finished: bool = True) -> Candidate:
    """Return a fit as a candidate, with its errors over all samples seen.

    A law has a handful of parameters against thousands of samples, so that the samples it was
    fitted to count, too; the charge is that of the Bayesian information criterion,
    for the effective number of parameters (Hastie, Tibshirani and Friedman 2009, The Elements of
    Statistical Learning, section 7.6).
    """
    count = int(problem.seen.sum())
    freedom = fit.freedom(problem.seen, problem.noise)
    charge = float(np.exp(0.5 * freedom * np.log(count) / count))
    rmse = problem.seen_rmse(fit.residual)
    return Candidate(fit, rmse, rmse * charge, freedom, finished)


def best_of_each_set(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Return the best candidate of every effect set (with its force ports), best first.

    A set is fitted from several starts, and in several orders. Finished and merely screened
    candidates are kept apart.
    """
    best: dict[tuple[EffectSet, bool], Candidate] = {}
    for candidate in sorted(candidates, key=lambda c: c.error):
        best.setdefault((frozenset(candidate.labels), candidate.finished), candidate)
    return list(best.values())
