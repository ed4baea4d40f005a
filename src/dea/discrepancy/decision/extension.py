"""The single effects that are proven, and the extension of the simulation to decide on."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.decision.adequacy import borne_out
from dea.discrepancy.evidence.bootstrap import Gains, beaten
from dea.discrepancy.evidence.certificate import transferable
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.presence import Presence, families_of
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.rules import Rules, misfit
from dea.discrepancy.search.rounds import Round

# Candidates of one size whose held-out errors are compared.
_LEADING = 6


def proven_alone(rounds: Sequence[Round], gained: Gains, rules: Rules) -> list[Candidate]:
    """Return the single effects whose gain is beyond the margin and beyond chance, best first."""
    needed = max(rules.needed_gain, gained.null)
    pairs = zip(rounds[0].candidates, gained.low, strict=True)
    return [c for c, low in pairs if c.finished and low > needed]


def sure_alone(evidence: Evidence, rounds: Sequence[Round], weighed: Presence) -> list[Candidate]:
    """Return the certain single effects that leave only noise where the simulation left more.

    The gain of an effect that acts rarely, such as a limit that is seldom reached, varies so much
    between blocks that it is not proven by their resampling.
    """
    rules, floor, before = evidence.rules, evidence.stated_floor, evidence.nominal_error
    sure = weighed.sure(rules.certain)
    singles = (c for c in rounds[0].candidates if c.finished and c.effects <= sure)
    complete = (c for c in singles if rules.completes(c.rmse, before, floor))
    return [c for c in complete if borne_out(evidence, c)]


def best_extension(
    evidence: Evidence, rounds: Sequence[Round], proven: Sequence[Candidate]
) -> Candidate | None:
    """Return the best single effect that is proven, or the best larger set that helps more.

    Of those whose held-out errors are as good as the best, down to the noise, it is the one with
    the least freedom.
    """
    held_out, floor, rules = evidence.held_out, evidence.floor, evidence.rules

    def simplest(candidates: Sequence[Candidate]) -> Candidate:
        leading = sorted(candidates, key=lambda c: c.error)[:_LEADING]
        errors = held_out.compared([c.fit for c in leading])
        equal = [
            (candidate, error)
            for candidate, error in zip(leading, errors, strict=True)
            if rules.as_good(error, min(errors), evidence.noise_floor)
        ]
        return min(equal, key=lambda pair: (round(pair[0].freedom), pair[1]))[0]

    chosen = simplest(proven) if proven else None
    larger = [c for r in rounds[1:] for c in r.candidates if c.finished]
    for size in sorted({len(c.names) for c in larger}):
        best = simplest([c for c in larger if len(c.names) == size])
        before = chosen.fit if chosen else rounds[0].before
        _, low = beaten(best.fit.residual, before.residual, evidence.blocks, evidence.resampling)
        # A course in time that leaves only noise is right, though it may be predicted badly at the
        # ends of the record, or of blocks in which it bends.
        left = evidence.problem.seen_rmse(before.residual)
        in_time = not transferable(best.fit.extended)
        complete = in_time and rules.completes(best.rmse, left, evidence.stated_floor)
        if not complete:
            with_more, with_less = held_out.compared([best.fit, before])
            if with_more >= with_less:
                continue
        if chosen is None:
            # Two effects at once, neither of which is proven alone, must remove twice the margin.
            if low > -np.log1p(-2 * rules.margin):
                chosen = best
            continue
        of_one_family = len(families_of(best)) < len(best.names)
        part = rules.misfit if of_one_family else rules.further
        needed = rules.leaves(part, chosen.rmse, evidence.nominal_error, floor)
        most = (1.0 - rules.second) * misfit(chosen.rmse, floor)
        if needed and low > rules.needed_gain and misfit(best.rmse, floor) <= most:
            chosen = best
    return chosen
