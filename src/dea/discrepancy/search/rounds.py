"""Build the extension step by step: effects come alone, in twos and in threes."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from dea.discrepancy.evidence.noise import white_level
from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.search.hints import jumps, lines
from dea.discrepancy.search.screening import Base, Offer, in_parallel, refine, screen
from dea.simulation import Effect, measured_scales, with_fine_steps

# Steps every finished candidate gets, and those that only candidates within a factor of the
# leader's error go on to.
_FIRST_STEPS, _LAST_STEPS, _NEAR = 6, 20, 2.5
# Fits of one effect, from different bases, that go beyond the screening.
_RUNNERS_UP = 2
# Leaders whose last steps have every column of the Jacobian computed anew.
_POLISHED = 2
# Noise floors above which they are fitted again from places around, and how far away these are
# (in prior spreads of the law).
_NEARLY_NOISE, _SHAKE = 1.15, 0.5
# A short record affords more than the least number of fits of one effect that go on: so many
# samples shared among them, and at most so many fits.
_SHORT, _MOST_KEPT = 24_000, 6


@dataclass(frozen=True)
class Budget:
    """How much is spent, the same for every candidate of a round.

    The nominal simulation is fitted from ``starts``; ``finished`` candidates of a round are
    fitted to the end, the rest only screened; from the ``beam`` best, the next round goes on; at
    most ``effects`` are attached. At least ``kept`` fits of one effect go on after ``screening``
    cheap steps, to as many whole ones. The best single effects are fitted again from ``shakes``
    places around, and the best pair gives up its effects ``exchanges`` times at most; without any,
    its partners are not extended either. A record of more than ``long_record`` samples has half of
    all this but as many effects, one shake, and no exchange.
    """

    starts: int = 4
    finished: int = 6
    beam: int = 2
    effects: int = 2
    kept: int = 2
    screening: int = 4
    shakes: int = 4
    exchanges: int = 3
    long_record: int = 30_000

    def of(self, samples: int) -> "Budget":
        """Return the budget for a record of this length."""
        if samples <= self.long_record:
            return self

        def half(count: int) -> int:
            return max(1, count // 2)

        return replace(
            self,
            starts=half(self.starts),
            finished=half(self.finished),
            beam=half(self.beam),
            kept=half(self.kept),
            screening=half(self.screening),
            shakes=min(1, self.shakes),
            exchanges=0,
        )


@dataclass(frozen=True)
class Candidate:
    """One effect more on a fitted simulation, and how well it explains the record.

    Parameters
    ----------
    rmse : float
        Over all samples seen.
    error : float
        The same with a charge for each parameter, to rank by.
    """

    fit: Fit
    rmse: float
    error: float
    finished: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all effects attached."""
        return tuple(a.effect.name for a in self.fit.extended.attached)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of all effects attached, with their balance where there are several."""
        return tuple(self.fit.extended.label(a) for a in self.fit.extended.attached)


@dataclass(frozen=True)
class Round:
    """All candidates that extend one simulation by one effect, best first."""

    before: Fit
    candidates: tuple[Candidate, ...] = field(default_factory=tuple)


def judge(problem: Problem, fit: Fit, finished: bool = True) -> Candidate:
    """Return a fit with its errors over all samples that may choose.

    A law has a handful of parameters against thousands of samples, so that what it was fitted on
    counts as evidence too; the charge is that of the Bayesian information criterion.
    """
    count = int(problem.seen.sum())
    charge = float(np.exp(0.5 * fit.coordinates.size * np.log(count) / count))
    rmse = problem.seen_rmse(fit.residual)
    return Candidate(fit, rmse, rmse * charge, finished)


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
    before = bases[0]
    kept = int(np.clip(_SHORT // problem.u.size, budget.kept, _MOST_KEPT))
    offers = _offers(problem, before, effects)
    prepared = [Base.of(problem, each) for each in bases]
    screened = in_parallel(
        lambda offer: screen(problem, prepared, offer, kept, budget.screening), offers, workers
    )

    def error(candidate: Fit) -> float:
        return problem.seen_rmse(candidate.residual)

    stable: dict[str, list[Fit]] = {}
    for fits in sorted((fits for fits in screened if fits), key=lambda fits: error(fits[0])):
        # Of one effect before and after another on a signal's way, the better goes on.
        stable.setdefault(fits[0].extended.label(fits[0].extended.attached[-1]), fits)
    leaders = list(stable.values())
    ahead = in_parallel(
        lambda fits: min(
            (refine(problem, each, _FIRST_STEPS) for each in fits[:_RUNNERS_UP]),
            key=error,
        ),
        leaders[: budget.finished],
        workers,
    )
    leader = min(map(error, ahead), default=0.0)
    near = [each for each in ahead if error(each) <= _NEAR * leader]
    finished = in_parallel(
        lambda each: refine(problem, _with_fine_steps(problem, each), _LAST_STEPS), near, workers
    )
    finished.sort(key=error)
    finished[:_POLISHED] = in_parallel(
        lambda each: _polished(problem, each, budget.shakes), finished[:_POLISHED], workers
    )
    finished += [each for each in ahead if error(each) > _NEAR * leader]
    candidates = [judge(problem, each) for each in finished]
    candidates += [judge(problem, fits[0], finished=False) for fits in leaders[budget.finished :]]
    return Round(before, tuple(sorted(candidates, key=lambda c: c.error)))


def _polished(problem: Problem, fitted: Fit, shakes: int) -> Fit:
    """Fit with every column anew, and where much is left, from places around as well.

    Laws with corners leave the least squares kinks to get caught on. Of several effects, the last
    has been fitted from enough places already.
    """
    whole = [slice(0, problem.u.size)]
    best = fit(problem, fitted.extended, fitted.coordinates, iterations=_LAST_STEPS)
    own = fitted.extended.free >= fitted.extended.effect_slices[-1].start
    count = shakes if len(fitted.extended.attached) == 1 else 0
    for push in _SHAKE * np.random.default_rng(0).standard_normal((count, own.size)):
        if problem.seen_rmse(best.residual) <= _NEARLY_NOISE * white_level(best.residual, whole):
            break
        shaken = best.coordinates + np.where(own, push, 0.0)
        best = min(
            (best, fit(problem, fitted.extended, shaken, iterations=_LAST_STEPS)),
            key=lambda each: each.cost,
        )
    return best


def _with_fine_steps(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit whose steps suit its effects; those of the simulation alone may be too long."""
    extended = with_fine_steps(
        fitted.extended,
        fitted.values,
        problem.u,
        problem.interval,
        problem.tolerance,
        problem.most_steps,
    )
    return replace(fitted, extended=extended)


def _offers(problem: Problem, before: Fit, effects: Sequence[Effect]) -> list[Offer]:
    """Return every effect at every port it can attach to and is not attached to yet."""
    ports = before.extended.simulation.force_ports
    frequencies, instants = lines(problem, before.residual), jumps(problem, before.residual)
    told = [
        replace(
            measured_scales(before.extended, before.values, problem, i),
            frequencies=frequencies,
            jumps=instants,
        )
        for i in range(max(1, len(ports)))
    ]
    there = {(a.effect.name, a.force_port) for a in before.extended.attached}
    on_input = any(a.effect.shape_input for a in before.extended.attached)
    on_output = any(a.effect.shape_output for a in before.extended.attached)
    offers = []
    for effect in effects:
        places = [0]
        if effect.force is not None:
            places = [
                i
                for i, port in enumerate(ports)
                if port.position is not None or not effect.uses_position
            ]
        meets = (effect.shape_input and on_input) or (effect.shape_output and on_output)
        sides = (False, True) if meets else (False,)
        offers += [
            Offer(effect, told[place], place, upstream)
            for place in places
            if (effect.name, place) not in there
            for upstream in sides
        ]
    return offers
