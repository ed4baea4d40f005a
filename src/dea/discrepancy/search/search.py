"""Which effect sets are tried: single effects, pairs and triples.

Two effects may each explain little, and a third one may stand for both. The search therefore goes
on from the best candidates and, where a pair explains much but not all, from the partners it has
found and from each of its effects in turn (sequential replacement: Miller 2002, Subset Selection in
Regression, ch. 3). In the end each effect of the leading pairs is fitted again on its own,
and the leading candidates from the prior means of the simulation.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice

from dea.discrepancy.budget import Budget
from dea.discrepancy.evidence.colour import leaves_coloured_noise
from dea.discrepancy.fitting.candidates import Candidate, best_of_each_set, judged
from dea.discrepancy.fitting.fit import Fit, without
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.search.rounds import (
    Round,
    extend_by_each,
    fitted_again,
    from_prior_means,
    with_shapes_anew,
)
from dea.simulation import Effect, Port

# Leading candidates that are fitted once more with their laws' shapes from the prior, and those of
# each round whose residuals show the noise floor.
_SHAPED_ANEW, _SHOWING_NOISE = 2, 3


@dataclass(frozen=True)
class Search:
    """What is offered to a simulation, and how much is spent on it.

    ``nominals`` are fits of the simulation to start from, the one to beat first. In ``blocks`` of
    the record coloured noise shows; without any, none is looked for.
    """

    problem: Problem
    nominals: Sequence[Fit]
    offered: Sequence[Effect]
    budget: Budget
    rules: Rules
    workers: int = 1
    blocks: Sequence[slice] = ()

    def rounds(self) -> list[Round]:
        """Offer every effect to the nominal simulation, then to its best extensions, and so on."""
        rounds = [self.singles]
        beam = self._diverse(rounds)
        for size in range(2, self.budget.effects + 1):
            if not beam or not self._lacking(beam):
                break
            grown = self._pairs_from(beam) if size == 2 else self._extended(beam)
            rounds += grown
            beam = self._leading(grown)
        return self._restarted([self._reduced(rounds), *rounds[1:]])

    @cached_property
    def singles(self) -> Round:
        """The round of single effects."""
        return self._round(self.nominals, self.offered)

    def _round(self, bases: Sequence[Fit], effects: Sequence[Effect]) -> Round:
        return extend_by_each(self.problem, bases, effects, self.budget, self.workers)

    def _extended(self, candidates: Sequence[Candidate]) -> list[Round]:
        return [self._round([c.fit], self._offered_beside(c)) for c in candidates]

    def _offered_beside(self, candidate: Candidate) -> Sequence[Effect]:
        """Return the effects that may be missing beside a candidate.

        Where it explains most and leaves coloured noise, which follows neither the input nor the
        motion, these are courses in time.
        """
        before = self.problem.seen_rmse(self.nominals[0].residual)
        explains = self.rules.removes_energy(candidate.rmse, before)
        # A further effect may hide in what is left beside several: less may then be predictable.
        most = self.rules.may_follow(len(candidate.names) + 1)
        if explains and leaves_coloured_noise(self.problem, candidate.fit, self.blocks, most):
            return [effect for effect in self.offered if not effect.transferable]
        return self.offered

    def _leading(self, rounds: Sequence[Round]) -> list[Candidate]:
        return finished_of(rounds)[: self.budget.beam]

    def _diverse(self, rounds: Sequence[Round]) -> list[Candidate]:
        """Return the leading candidates, and the first that acts elsewhere than any of them.

        Alone a right effect may rank behind several that distort the reading as two effects do.
        """

        def ports(candidate: Candidate) -> set[Port]:
            return {a.effect.port for a in candidate.fit.extended.attached}

        leading = self._leading(rounds)
        there = {port for c in leading for port in ports(c)}
        others = (c for c in finished_of(rounds) if not ports(c) & there)
        return [*leading, *islice(others, 1)]

    def _pairs_from(self, beam: Sequence[Candidate]) -> list[Round]:
        grown = self._extended(beam)
        if not self.budget.exchanges:
            return grown
        if self._better(grown):
            found = {c.labels[-1] for c in self._leading(grown)} - {c.labels[-1] for c in beam}
            partners = [c for c in self.singles.candidates if c.labels[-1] in found]
            grown += self._extended(partners)
        for _ in range(self.budget.exchanges):
            if not self._open(grown):
                break
            pair = self._leading(grown)[0]
            grown += self._exchanged(pair)
            if self._leading(grown)[0].error > self.budget.exchange_gain * pair.error:
                break
        return grown

    def _exchanged(self, pair: Candidate) -> list[Round]:
        """Offer the leading effects beside each effect of a pair, as the pair has fitted it."""
        finished = [c.fit for c in self.singles.candidates if c.finished]
        leading = {a.effect.name for each in (pair.fit, *finished) for a in each.extended.attached}
        effects = [effect for effect in self.offered if effect.name in leading]
        kept = [without(self.problem, pair.fit, i) for i in range(len(pair.names))]
        return [self._round([fitted], effects) for fitted in kept if fitted.stable]

    def _reduced(self, rounds: Sequence[Round]) -> Round:
        """Return the round of single effects, those fitted again that a leading pair helped.

        A second effect can lead the first one out of a local minimum and then be of no use.
        """
        starts = [
            without(self.problem, pair.fit, i)
            for pair in self._leading(rounds[1:])
            for i in range(len(pair.names))
            if len(pair.names) == 2
        ]
        again = [fitted_again(self.problem, start, self.budget) for start in starts if start.stable]
        candidates = best_of_each_set(
            [*self.singles.candidates, *(judged(self.problem, each) for each in again)]
        )
        # A candidate that was only screened is replaced by its finished fit.
        finished = {c.labels for c in candidates if c.finished}
        kept = (c for c in candidates if c.finished or c.labels not in finished)
        return replace(self.singles, candidates=tuple(kept))

    def _restarted(self, rounds: Sequence[Round]) -> list[Round]:
        """Return the rounds with the leading candidates fitted again, if more than noise is left.

        The first few get new shapes in any case: their residual may look like noise only because
        their laws have adapted to an effect in the wrong place.
        """
        finished, found = finished_of(rounds)[: self.budget.restarted], list(rounds)
        limit = self.budget.near * min((c.error for c in finished), default=0.0)
        leading = [c for c in finished if c.error <= limit]
        if leading and leading[0].rmse > self.budget.exchange_above * self._lowest_level(leading):
            step = "leading candidates from the prior means of the simulation"
            found = self._fitted_anew(found, leading, from_prior_means, step)
        shaped = finished_of(found)[: min(_SHAPED_ANEW, self.budget.restarted)]
        return self._fitted_anew(found, shaped, with_shapes_anew, "leading laws shaped anew")

    def _fitted_anew(
        self,
        rounds: Sequence[Round],
        leading: Sequence[Candidate],
        attempt: Callable[[Problem, Fit, Budget], Fit],
        step: str,
    ) -> list[Round]:
        """Return the rounds with leading candidates replaced where an ``attempt`` is better."""
        again = in_parallel(
            lambda c: judged(self.problem, attempt(self.problem, c.fit, self.budget)),
            leading,
            self.workers,
            step,
        )
        pairs = zip(leading, again, strict=True)
        better = {id(old): new for old, new in pairs if new.fit.stable and new.error < old.error}

        def kept(each: Round) -> tuple[Candidate, ...]:
            found = (better.get(id(c), c) for c in each.candidates)
            return tuple(sorted(found, key=lambda c: c.error))

        return [replace(each, candidates=kept(each)) for each in rounds]

    def _lacking(self, candidates: Sequence[Candidate]) -> bool:
        nominal_error = self.problem.seen_rmse(self.nominals[0].residual)
        level = self._lowest_level(candidates)
        part = max(self.budget.room, self.rules.further)
        return self.rules.leaves(part, candidates[0].rmse, nominal_error, level)

    def _open(self, grown: Sequence[Round]) -> bool:
        """Return whether the best pair is better than any single effect, but not the answer."""
        pairs = self._leading(grown)
        if not pairs or pairs[0].rmse <= self.budget.exchange_above * self._lowest_level(pairs):
            return False
        return self._better(grown)

    def _better(self, grown: Sequence[Round]) -> bool:
        """Return whether the best pair is better than any single effect."""
        pairs, singles = self._leading(grown), self._leading([self.singles])
        return bool(pairs) and self._left(pairs) <= self.budget.exchange_misfit * self._left(
            singles
        )

    def _left(self, candidates: Sequence[Candidate]) -> float:
        return misfit(candidates[0].rmse, self._lowest_level(candidates))

    def _lowest_level(self, candidates: Sequence[Candidate]) -> float:
        return self.problem.white_level(*(c.fit.residual for c in candidates))


def pool_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Return the best candidate of every effect set that was tried, best first."""
    return best_of_each_set(c for r in rounds for c in r.candidates)


def finished_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Return those of the pool that were fitted to the end, best first."""
    return [c for c in pool_of(rounds) if c.finished]


def noise_floor(problem: Problem, rounds: Sequence[Round]) -> float:
    """Return the lowest white level that the simulation or a leading candidate leaves."""
    leading = [c.fit for r in rounds for c in r.candidates[:_SHOWING_NOISE] if c.finished]
    return problem.white_level(*(each.residual for each in (rounds[0].before, *leading)))
