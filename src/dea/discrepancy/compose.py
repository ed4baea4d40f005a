"""Build the extension step by step: effects come alone, in twos and in threes."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dea.discrepancy.candidates import in_parallel, refine, screen
from dea.discrepancy.effects import Effect
from dea.discrepancy.fit import Fit
from dea.discrepancy.hints import jumps, lines
from dea.discrepancy.noise import white_level
from dea.discrepancy.problem import Problem, rmse, scales


@dataclass(frozen=True)
class Budget:
    """How much is spent, the same for every candidate of a round.

    ``finished`` candidates of a round are fitted to the end, the rest only screened; from the
    ``beam`` best, the next round goes on; at most ``effects`` are attached.
    """

    finished: int = 7
    beam: int = 2
    effects: int = 2


@dataclass(frozen=True)
class Candidate:
    """One effect more on a fitted simulation, and how well it explains the record."""

    fit: Fit
    error: float
    held_out: float
    finished: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all effects attached."""
        return tuple(a.effect.name for a in self.fit.extended.attached)

    @property
    def effect(self) -> Effect:
        """The effect attached last."""
        return self.fit.extended.attached[-1].effect


@dataclass(frozen=True)
class Round:
    """All candidates that extend one simulation by one effect, best first."""

    before: Fit
    candidates: tuple[Candidate, ...] = field(default_factory=tuple)


def seen_error(problem: Problem, fit: Fit) -> float:
    """Return the RMSE over all samples that may choose, with a charge for each parameter.

    A law has a handful of parameters against thousands of samples, so that what it was fitted on
    counts as evidence too; the charge is that of the Bayesian information criterion.
    """
    seen = problem.fit | problem.select
    count = int(seen.sum())
    charge = np.exp(0.5 * fit.coordinates.size * np.log(count) / count)
    return rmse(fit.gap, seen) * float(charge)


def judge(problem: Problem, fit: Fit, finished: bool = True) -> Candidate:
    """Return a fit with its errors."""
    return Candidate(fit, seen_error(problem, fit), rmse(fit.gap, problem.select), finished)


def extend_by_each(
    problem: Problem,
    before: Fit,
    effects: Sequence[Effect],
    units: tuple[str, str],
    budget: Budget,
    workers: int,
) -> Round:
    """Fit each effect on top of ``before``: all from all their starts, the best to the end."""
    around = scales(
        problem, before.extended, before.values, units, lines(problem, before.gap),
        jumps(problem, before.gap),
    )  # fmt: skip
    there = {a.effect.name for a in before.extended.attached}
    offered = [e for e in effects if e.name not in there and _attachable(e, before)]
    screened = in_parallel(lambda effect: screen(problem, before, effect, around), offered, workers)
    stable = sorted(
        (fits[0] for fits in screened if fits and fits[0].stable), key=lambda fit: fit.cost
    )
    finished = in_parallel(lambda fit: refine(problem, fit), stable[: budget.finished], workers)
    candidates = [judge(problem, fit) for fit in finished]
    candidates += [judge(problem, fit, finished=False) for fit in stable[budget.finished :]]
    return Round(before, tuple(sorted(candidates, key=lambda c: c.error)))


def noise_floor(problem: Problem, rounds: Sequence[Round], blocks: Sequence[slice]) -> float:
    """Return the lowest white level any simulation leaves over."""
    gaps = [rounds[0].before.gap]
    gaps += [c.fit.gap for r in rounds for c in r.candidates[:3] if c.finished]
    return min(white_level(gap, list(blocks)) for gap in gaps)


def _attachable(effect: Effect, before: Fit) -> bool:
    if effect.force is None:
        return True
    balance = before.extended.simulation.balance
    return balance is not None and (balance.position is not None or not effect.uses_position)
