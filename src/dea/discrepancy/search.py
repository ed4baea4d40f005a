"""Which extensions are tried, and which is best: effects come alone, in twos and in threes.

Two effects may each explain little, and a third one may pass for both; so the search goes on from
the best, then once more from the partners it has found, and at last gives up each effect of the
best pair in turn for others beside the one that is kept (backfitting, Breiman and Friedman 1985).
"""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.compose import Budget, Candidate, Round, extend_by_each
from dea.discrepancy.decide import Evidence, Rules, as_good, misfit
from dea.discrepancy.effects import Effect
from dea.discrepancy.fit import Fit, without
from dea.discrepancy.gain import Gains
from dea.discrepancy.noise import white_level
from dea.discrepancy.problem import Problem
from dea.discrepancy.rivals import beaten

# Noise floors above which a pair may be one law taken for another.
_NOISE_ALONE = 1.05
# How often the best pair gives up its effects in turn, and the factor its error must fall by for
# one time more.
_EXCHANGES, _BETTER = 3, 0.9


def search(
    problem: Problem,
    nominals: Sequence[Fit],
    offered: Sequence[Effect],
    units: tuple[str, str],
    budget: Budget,
    rules: Rules,
    workers: int,
) -> list[Round]:
    """Offer every effect to the nominal simulation, then to its best extensions, and so on.

    ``nominals`` are fits of the simulation to start from, the one to beat first.
    """
    rounds = [extend_by_each(problem, nominals, offered, units, budget, workers)]
    whole = [slice(0, problem.u.size)]
    nominal_error = problem.seen_rmse(nominals[0].gap)

    def floor_of(candidates: Sequence[Candidate]) -> float:
        return min((white_level(c.fit.gap, whole) for c in candidates), default=0.0)

    def explained(candidates: Sequence[Candidate]) -> bool:
        floor = floor_of(candidates)
        return not candidates or not leaves_room(candidates[0].rmse, nominal_error, floor, rules)

    def clean(candidates: Sequence[Candidate]) -> bool:
        return not candidates or candidates[0].rmse <= _NOISE_ALONE * floor_of(candidates)

    def exchange(pair: Candidate) -> list[Round]:
        leading = {c.names[-1] for c in singles if c.finished} | set(pair.names)
        kept = [without(problem, pair.fit, i) for i in range(len(pair.names))]
        effects = [effect for effect in offered if effect.name in leading]
        return [
            extend_by_each(problem, [fitted], effects, units, budget, workers)
            for fitted in kept
            if fitted.stable
        ]

    def extend(candidates: Sequence[Candidate]) -> list[Round]:
        return [
            extend_by_each(problem, [c.fit], offered, units, budget, workers) for c in candidates
        ]

    singles = rounds[0].candidates
    beam = [c for c in singles if c.finished][: budget.beam]
    for size in range(2, budget.effects + 1):
        if explained(beam):
            break
        grown = extend(beam)
        best = pool_of(grown)[: budget.beam]
        if size == 2 and not clean(best):
            partners = {c.labels[-1] for c in best} - {c.labels[-1] for c in beam}
            grown += extend([c for c in singles if c.labels[-1] in partners])
            for _ in range(_EXCHANGES):
                pair = pool_of(grown)[0]
                if clean([pair]):
                    break
                grown += exchange(pair)
                if pool_of(grown)[0].error > _BETTER * pair.error:
                    break
        rounds += grown
        beam = [c for c in pool_of(grown) if c.finished][: budget.beam]
    return rounds


def leaves_room(error: float, nominal_error: float, floor: float, rules: Rules) -> bool:
    """Return whether an error leaves room for a further effect."""
    if error <= rules.clean * floor:
        return False
    left, whole = misfit(error, floor), misfit(nominal_error, floor)
    return error > rules.grow * floor or left > rules.misfit * whole


def noise_floor(rounds: Sequence[Round], blocks: Sequence[slice]) -> float:
    """Return the lowest white level any simulation leaves over."""
    gaps = [rounds[0].before.gap]
    gaps += [c.fit.gap for r in rounds for c in r.candidates[:3] if c.finished]
    return min(white_level(gap, list(blocks)) for gap in gaps)


def proven_alone(rounds: Sequence[Round], gained: Gains, rules: Rules) -> list[Candidate]:
    """Return the single effects whose gain is beyond the margin and beyond chance, best first."""
    needed = max(-np.log1p(-rules.margin), gained.null)
    pairs = zip(rounds[0].candidates, gained.low, strict=True)
    return [c for c, low in pairs if c.finished and low > needed]


def best_extension(
    evidence: Evidence, rounds: Sequence[Round], proven: Sequence[Candidate]
) -> Candidate | None:
    """Return the best single effect that is proven, or the best larger set that helps more.

    Of those that are as good as the best, down to the noise, it is the one with the fewest
    parameters.
    """
    held_out, floor, rules = evidence.held_out, evidence.floor, evidence.rules

    def simplest(candidates: Sequence[Candidate]) -> Candidate:
        best = min(candidates, key=lambda c: c.error)
        equal = [c for c in candidates if as_good(c, best, evidence.noise, rules)]
        return min(equal, key=lambda c: (c.fit.coordinates.size, c.error))

    chosen = simplest(proven) if proven else None
    larger = [c for r in rounds[1:] for c in r.candidates if c.finished]
    for size in sorted({len(c.names) for c in larger}):
        best = simplest([c for c in larger if len(c.names) == size])
        before = chosen.fit if chosen else rounds[0].before
        _, low = beaten(best.fit.gap, before.gap, evidence.blocks, evidence.rng)
        if held_out.rmse(best.fit) >= held_out.rmse(before):
            continue
        if chosen is None:
            if low > -np.log1p(-2 * rules.margin):
                chosen = best
            continue
        needed = leaves_room(chosen.rmse, evidence.nominal_error, floor, rules)
        left = (1.0 - rules.second) * misfit(chosen.rmse, floor)
        if needed and low > -np.log1p(-rules.margin) and misfit(best.rmse, floor) <= left:
            chosen = best
    return chosen


def pool_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Return all candidates of all rounds, best first."""
    return sorted((c for r in rounds for c in r.candidates), key=lambda c: c.error)
