"""Screen an effect: fit it by a few cheap steps from its most promising starts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Columns, Fit, fit
from dea.discrepancy.problem import Problem, rmse
from dea.discrepancy.sensitivity import unabsorbed
from dea.simulation import Effect, ExtendedSimulation, Scales

# Fits beyond the kept ones that go on after the cheap steps, which rank them only roughly.
_MORE = 1
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

    From each of the ``bases`` (fits of the same simulation) the most promising starts go on, half
    as many as are ``kept``. Their first steps use the base's Jacobian for all parameters that the
    base has; the best of them, one more than are kept (or the best alone), get steps with a
    Jacobian of their own. Parameters that shape a law are held. An effect without a start in this
    record has no fit.
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
        for base in bases
        for start in promising(problem, base, extended, starts)[: max(1, kept // 2)]
    ]
    if min(map(error, cheap)) > error(bases[0].fit):
        # A law contains the simulation without it: no fit needs to end worse.
        start = where_it_does_nothing(problem, bases[0], extended, starts)
        cheap += [] if start is None else [first_steps(bases[0], start)]
    cheap.sort(key=error)
    whole = [
        refine(problem, each, steps, held)
        for each in cheap[: kept + min(_MORE, kept - 1)]
        if each.stable
    ]
    return sorted((each for each in whole if each.stable), key=error)[:kept]


def promising(
    problem: Problem,
    base: Base,
    extended: ExtendedSimulation,
    starts: Sequence[tuple[float, ...]],
) -> list[np.ndarray]:
    """Return the coordinates of the starts, first those that explain most of a base's residual.

    A start explains what the change of the output that the law causes there does, scaled to its
    best size, with the simulation's parameters refitted by a linear step.
    """
    seen, before = problem.seen, base.fit.residual
    left = base.remainder(before[seen])

    def explained(coordinates: np.ndarray) -> float:
        residual = problem.residual(extended, extended.values(coordinates))
        if not np.isfinite(residual).all():
            return -1.0
        change = base.remainder((before - residual)[seen])
        return float(max(change @ left, 0.0) ** 2 / max(change @ change, 1e-300))

    law = extended.attached[-1]
    placed = [
        extended.coordinates(np.concatenate([base.fit.values, law.started(start)]))
        for start in starts
    ]
    return sorted(placed, key=explained, reverse=True)


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
