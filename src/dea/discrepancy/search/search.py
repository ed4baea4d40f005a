"""Which extensions are tried: effects come alone, in twos and in threes.

Two effects may each explain little, and a third one may pass for both; so the search goes on from
the best, and where a pair explains much but not all, from the partners it has found and from each
of its effects in turn (sequential replacement: Miller 2002, Subset Selection in Regression, ch. 3).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from dea.discrepancy.decision import Rules, leaves_room, misfit
from dea.discrepancy.evidence.noise import white_level
from dea.discrepancy.fit import Fit, without
from dea.discrepancy.problem import Problem
from dea.discrepancy.search.rounds import Budget, Candidate, Round, extend_by_each
from dea.simulation import Effect

# Noise floors above which a pair may hold one law taken for another, if it leaves less than this
# part of the misfit of the best effect alone.
_NOISE_ALONE, _PARTLY = 1.05, 0.8
# Factor that the error of the best pair must fall by for it to give up its effects once more.
_BETTER = 0.9


@dataclass(frozen=True)
class Search:
    """What is offered to a simulation, and how much is spent on it.

    ``nominals`` are fits of the simulation to start from, the one to beat first.
    """

    problem: Problem
    nominals: Sequence[Fit]
    offered: Sequence[Effect]
    budget: Budget
    rules: Rules
    workers: int

    def rounds(self) -> list[Round]:
        """Offer every effect to the nominal simulation, then to its best extensions, and so on."""
        rounds = [self.singles]
        beam = self._leading(rounds)
        for size in range(2, self.budget.effects + 1):
            if not beam or not self._lacking(beam):
                break
            grown = self._pairs_from(beam) if size == 2 else self._extended(beam)
            rounds += grown
            beam = self._leading(grown)
        return rounds

    @cached_property
    def singles(self) -> Round:
        """The round of effects that come alone."""
        return self._round(self.nominals, self.offered)

    def _round(self, bases: Sequence[Fit], effects: Sequence[Effect]) -> Round:
        return extend_by_each(self.problem, bases, effects, self.budget, self.workers)

    def _extended(self, candidates: Sequence[Candidate]) -> list[Round]:
        return [self._round([c.fit], self.offered) for c in candidates]

    def _leading(self, rounds: Sequence[Round]) -> list[Candidate]:
        return [c for c in pool_of(rounds) if c.finished][: self.budget.beam]

    def _pairs_from(self, beam: Sequence[Candidate]) -> list[Round]:
        grown = self._extended(beam)
        if not self.budget.exchanges:
            return grown
        if self._open(grown):
            found = {c.labels[-1] for c in self._leading(grown)} - {c.labels[-1] for c in beam}
            partners = [c for c in self.singles.candidates if c.labels[-1] in found]
            grown += self._extended(partners)
        for _ in range(self.budget.exchanges):
            if not self._open(grown):
                break
            pair = self._leading(grown)[0]
            grown += self._exchanged(pair)
            if self._leading(grown)[0].error > _BETTER * pair.error:
                break
        return grown

    def _exchanged(self, pair: Candidate) -> list[Round]:
        """Offer the leading effects beside each of a pair, as the pair has fitted it."""
        leading = {c.names[-1] for c in self.singles.candidates if c.finished} | set(pair.names)
        effects = [effect for effect in self.offered if effect.name in leading]
        kept = [without(self.problem, pair.fit, i) for i in range(len(pair.names))]
        return [self._round([fitted], effects) for fitted in kept if fitted.stable]

    def _lacking(self, candidates: Sequence[Candidate]) -> bool:
        nominal_error = self.problem.seen_rmse(self.nominals[0].residual)
        return leaves_room(candidates[0].rmse, nominal_error, self._floor(candidates), self.rules)

    def _open(self, grown: Sequence[Round]) -> bool:
        """Return whether the best pair is better than any single effect, but not the answer."""
        pairs, singles = self._leading(grown), self._leading([self.singles])
        if not pairs or pairs[0].rmse <= _NOISE_ALONE * self._floor(pairs):
            return False
        return self._left(pairs) <= _PARTLY * self._left(singles)

    def _left(self, candidates: Sequence[Candidate]) -> float:
        return misfit(candidates[0].rmse, self._floor(candidates))

    def _floor(self, candidates: Sequence[Candidate]) -> float:
        return min(white_level(c.fit.residual, [slice(0, c.fit.residual.size)]) for c in candidates)


def noise_floor(rounds: Sequence[Round], blocks: Sequence[slice]) -> float:
    """Return the lowest white level any simulation leaves over."""
    residuals = [rounds[0].before.residual]
    residuals += [c.fit.residual for r in rounds for c in r.candidates[:3] if c.finished]
    return min(white_level(residual, list(blocks)) for residual in residuals)


def pool_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Return the best candidate of every set of effects that was tried, best first.

    A set is tried from several starts, in several orders.
    """
    best: dict[tuple[frozenset[str], bool], Candidate] = {}
    for candidate in sorted((c for r in rounds for c in r.candidates), key=lambda c: c.error):
        best.setdefault((frozenset(candidate.labels), candidate.finished), candidate)
    return list(best.values())
