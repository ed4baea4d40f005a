"""The extension that is proven: a single effect, or a larger set that helps more."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.decision import Evidence, Rules, as_good, leaves_room, misfit
from dea.discrepancy.evidence.confusion import beaten
from dea.discrepancy.evidence.gain import Gains
from dea.discrepancy.search.rounds import Candidate, Round


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
        _, low = beaten(best.fit.residual, before.residual, evidence.blocks, evidence.rng)
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
