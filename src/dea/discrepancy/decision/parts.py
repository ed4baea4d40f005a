"""Which effects of an answer are certain, and whether each of several is needed."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.discrepancy.decision.adequacy import share_of
from dea.discrepancy.evidence.certificate import has_course_of_reading, transferable
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.modulation import follows_motion
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.fitting.candidates import Candidate, EffectSet
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.rules import Rules, misfit
from dea.simulation import Family


def certain_part(
    evidence: Evidence,
    pool: Sequence[Candidate],
    weighed: Presence,
    *,
    with_others: bool = False,
) -> Candidate | None:
    """Return the smallest set of certain effects that passes all tests, or a larger one.

    Whatever else the answer holds, these effects are in it. The best explanation without one of
    them and any of its family must leave much more of the misfit than the best one with all, since
    an effect that the catalogue lacks is often half explained by several. No explanation may leave
    less than the best one that holds them. They must surely remove most of the gap, by themselves
    or, if that is allowed, ``with_others``, as part of that explanation. In that case they must
    surely remove some of it by themselves, the best one without them must leave much more, whatever
    its families, and none may be a course in time, which follows whatever else is slow. A larger
    certain set is taken where it passes for its further effects. What it leaves may not be the wave
    of a disturbance in it, changed by the motion: then that is no disturbance.
    """
    sure = weighed.sure(evidence.rules.certain)
    finished = [c for c in pool if c.finished]
    tests = _PartTests(evidence, finished, with_others)
    certain = sorted(
        (c for c in finished if c.effects <= sure), key=lambda c: (len(c.effects), c.error)
    )
    part = next((c for c in certain if tests.needed(c) and tests.removes_most(c)), None)
    if part is None:
        return None
    wider = (c for c in certain if c.effects > part.effects and tests.needed(c, part.effects))
    named = next(wider, part)
    return None if follows_motion(evidence.problem, named.fit, evidence.rules) else named


@dataclass(frozen=True)
class _PartTests:
    """Tests of a part of the answer against all that was ``finished``."""

    evidence: Evidence
    finished: Sequence[Candidate]
    with_others: bool

    @property
    def _rules(self) -> Rules:
        return self.evidence.rules

    @cached_property
    def _least(self) -> float:
        """The error of the best explanation."""
        return min((c.rmse for c in self.finished), default=0.0)

    @cached_property
    def _families(self) -> dict[str, Family]:
        """The family of each effect."""
        return {
            name: a.effect.family
            for c in self.finished
            for name, a in zip(c.counted, c.fit.extended.attached, strict=True)
        }

    def needed(self, part: Candidate, given: EffectSet = frozenset()) -> bool:
        """Return whether the answer holds each effect of a part that is not ``given``."""
        further = part.effects - given
        return (
            all(self._ahead(part, name, given) for name in further)
            and self._unrivalled(part)
            and each_adds(self.evidence, part, self.finished)
        )

    def removes_most(self, part: Candidate) -> bool:
        """Return whether a part surely removes most of the gap, alone or with others."""
        rules = self._rules
        alone = share_of(self.evidence, part.fit).low
        if alone >= rules.part:
            return True
        if not (self.with_others and alone > rules.law_error and transferable(part.fit.extended)):
            return False
        without = (c for c in self.finished if not c.effects >= part.effects)
        return (
            self._far_behind(without, part)
            and share_of(self.evidence, self._best_with(part).fit).low >= rules.part
        )

    def _best_with(self, part: Candidate) -> Candidate:
        return min((c for c in self.finished if c.effects >= part.effects), key=lambda c: c.rmse)

    def _far_behind(self, others: Iterable[Candidate], part: Candidate) -> bool:
        """Return whether all others leave much more than the best explanation with the part."""
        floor = self.evidence.stated_floor
        within, least = self._best_with(part).rmse, min((c.rmse for c in others), default=np.inf)
        return misfit(within, floor) <= (1.0 - self._rules.ahead) * misfit(least, floor)

    def _ahead(self, part: Candidate, name: str, given: EffectSet) -> bool:
        """Return whether every explanation without the family leaves much more, and none less.

        The effects ``given`` may be in these.
        """
        family = self._families[name]
        kin = {other for other, its in self._families.items() if its is family} - given
        without = (c for c in self.finished if not c.effects & kin)
        floor = self.evidence.stated_floor
        return self._far_behind(without, part) and self._rules.as_good(
            self._best_with(part).rmse, self._least, floor
        )

    def _unrivalled(self, part: Candidate) -> bool:
        """Return whether no other set of as many effects has nearly the same error."""
        others = (c for c in self.finished if len(c.effects) == len(part.effects) > 1)
        return all(
            c.effects == part.effects or not self._rules.nearly(c.error, part.error) for c in others
        )


def each_adds(evidence: Evidence, chosen: Candidate, pool: Sequence[Candidate]) -> bool:
    """Return whether each of several effects removes much of what the others leave.

    Blocks left out are used, because a second law can be fitted to the error of the first. Where a
    course in time of the device bends within them, its error hides what its partner adds: if both
    together leave only noise, each may remove most of what the other leaves on the blocks fitted to
    instead. If a set without one of the effects was never fitted to the end, it is refitted from
    the chosen values.
    """
    if len(chosen.effects) == 1:
        return True
    rules = evidence.rules

    def others(index: int) -> Fit:
        remaining = chosen.effects - {chosen.counted[index]}
        there = (c for c in pool if c.finished and c.effects == remaining)
        best = min(there, key=lambda c: c.rmse, default=None)
        return best.fit if best else evidence.refitted_without(chosen.fit, index)

    without = [others(index) for index in range(len(chosen.names))]

    def removes(part: float, error: Callable[[Fit], float]) -> bool:
        left, *least = (misfit(error(each), evidence.floor) for each in (chosen.fit, *without))
        return left <= (1.0 - part) * min(least)

    if removes(rules.part, lambda fitted: evidence.held_out.rmse(fitted, chosen.fit)):
        return True
    complete = chosen.rmse <= rules.grow * evidence.stated_floor
    extended = chosen.fit.extended
    if not complete or transferable(extended) or has_course_of_reading(extended):
        return False
    return removes(rules.second, lambda fitted: evidence.problem.seen_rmse(fitted.residual))
