"""Screen an effect: fit it by a few cheap steps from its most promising starts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Columns, Fit, fit
from dea.discrepancy.problem import Problem, rmse
from dea.discrepancy.sensitivity import unabsorbed
from dea.simulation import Effect, ExtendedSimulation, Scales

# Starts that get cheap steps beyond the kept ones, and fits that go on after them beyond the two
# that are used: both are ranked only roughly.
_MORE = 1
_USED = 2
# Change of the output, in noise deviations, up to which a law does nothing; and the distance from
# the prior, in spreads, at which it is looked for where there is no bound.
_NOTHING, _FAR = 0.3, 6.0


@dataclass(frozen=True)
class Base:
    """A fit to start from, and what its parameters cannot absorb of a change of the output."""

    fit: Fit
    remainder: Callable[[np.ndarray], np.ndarray]

    @classmethod
    def of(cls, problem: Problem, fitted: Fit) -> "Base":
        """Prepare a fit; all effects offered share it."""
        return cls(fitted, unabsorbed(fitted.jacobian[problem.seen], problem.noise))


@dataclass(frozen=True)
class Offer:
    """An effect, the port and place at which it would be attached, and its scales."""

    effect: Effect
    scales: Scales
    force_port: int = 0
    upstream: bool = False


def screen(
    problem: Problem, bases: Sequence[Base], offer: Offer, kept: int, steps: int
) -> list[Fit]:
    """Fit an effect by a few cheap ``steps``; return at most ``kept`` stable fits, best first.

    Of the starts from all ``bases`` (fits of the same simulation) the most promising go on, one
    more than are ``kept``. Their first steps use the base's Jacobian for all parameters that the
    base has; the best of them get steps with a Jacobian of their own. Parameters that shape a law
    are held. An effect without a start in this record has no fit.
    """
    extended = bases[0].fit.extended.attach(
        offer.effect, offer.scales, offer.force_port, offer.upstream
    )
    held = extended.shapes
    starts = offer.effect.starts(offer.scales)
    if not starts:
        return []

    def error(candidate: Fit) -> float:
        return problem.seen_rmse(candidate.residual)

    def first_steps(base: Base, start: np.ndarray) -> Fit:
        kept_columns = Columns(held=held, kept=base.fit.jacobian)
        return fit(problem, extended, start, iterations=steps, columns=kept_columns)

    cheap = [
        first_steps(base, start)
        for base, start in promising(problem, bases, extended, starts, kept)
    ]
    if min(map(error, cheap)) > error(bases[0].fit):
        # A law contains the simulation without it: no fit needs to end worse.
        start = where_it_does_nothing(problem, bases[0], extended, starts)
        cheap += [] if start is None else [first_steps(bases[0], start)]
    cheap.sort(key=error)
    whole = [
        refine(problem, each, steps, held)
        for each in cheap[: min(kept, _USED + _MORE)]
        if each.stable
    ]
    return sorted((each for each in whole if each.stable), key=error)[:kept]


def promising(
    problem: Problem,
    bases: Sequence[Base],
    extended: ExtendedSimulation,
    starts: Sequence[tuple[float, ...]],
    kept: int,
) -> list[tuple[Base, np.ndarray]]:
    """Return bases with the coordinates of a start, first those that promise the least residual.

    What is left of a base's residual is what neither its parameters nor the change of the output
    that the law causes there, scaled to its best size, make up for by a linear step. There is one
    pair more than are ``kept``, of one base half as many at most.
    """
    seen = problem.seen
    law = extended.attached[-1]
    found: list[tuple[float, Base, np.ndarray]] = []
    for base in bases:
        before = base.fit.residual
        left = base.remainder(before[seen])
        own: list[tuple[float, Base, np.ndarray]] = []
        for start in starts:
            placed = extended.coordinates(np.concatenate([base.fit.values, law.started(start)]))
            residual = problem.residual(extended, extended.values(placed))
            explained = -1.0
            if np.isfinite(residual).all():
                change = base.remainder((before - residual)[seen])
                explained = max(change @ left, 0.0) ** 2 / max(change @ change, 1e-300)
            own.append((float(left @ left - explained), base, placed))
        found += sorted(own, key=lambda pair: pair[0])[: max(1, kept // 2)]
    found.sort(key=lambda pair: pair[0])
    return [(base, placed) for _, base, placed in found[: kept + min(_MORE, kept - 1)]]


def where_it_does_nothing(
    problem: Problem,
    base: Base,
    extended: ExtendedSimulation,
    starts: Sequence[tuple[float, ...]],
) -> np.ndarray | None:
    """Return coordinates at which the last law attached changes least, if it then hardly does.

    One parameter of a start at a time is put at its bounds, or far from its prior: a threshold at
    zero, a limit beyond the range, a stiffness of nothing.
    """
    law = extended.attached[-1]
    first = base.fit.coordinates.size
    low, high = extended.bounds
    seen, noise = problem.seen, problem.noise
    least, found = _NOTHING * noise, None
    for start in starts:
        placed = extended.coordinates(np.concatenate([base.fit.values, law.started(start)]))
        for i in range(first, placed.size):
            for end in (max(low[i], -_FAR), min(high[i], _FAR)):
                moved = placed.copy()
                moved[i] = end
                change = problem.residual(extended, extended.values(moved)) - base.fit.residual
                size = rmse(change, seen)
                if size < least:
                    least, found = size, moved
    return found


def refine(problem: Problem, screened: Fit, iterations: int, held: np.ndarray | None = None) -> Fit:
    """Continue a screened fit with a Jacobian of all parameters, or of all that are not held."""
    own = screened.extended.effect_slices[-1]
    known = int(np.sum(screened.extended.free < own.start))
    return fit(
        problem,
        screened.extended,
        screened.coordinates,
        iterations=iterations,
        columns=Columns(held=held, slow=known),
    )
