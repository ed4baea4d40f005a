"""Fit every effect of the catalogue to a record, each with the same freedom and budget."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.effects import Effect, Scales
from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.problem import Problem

_GLANCE_ITERATIONS, _SCREEN_ITERATIONS = 1, 4
# Bases beyond the kept ones that a first step does not rule out.
_MORE = 1


@dataclass(frozen=True)
class Offer:
    """An effect, where it would attach, and the scales it is told."""

    effect: Effect
    scales: Scales
    balance: int = 0


def screen(problem: Problem, bases: Sequence[Fit], offer: Offer, kept: int) -> list[Fit]:
    """Fit an effect by a few cheap steps; return the stable ones of ``kept`` fits, best first.

    One step from each of its starts on each of the ``bases`` (fits of the same simulation) tells
    the best start of each base. Shapes of laws are held, and the Jacobian of what is there already
    is kept as it was in its base. Little more than ``kept`` of them go on with such steps, and the
    ``kept`` best then with whole ones; where one is kept, the first step decides. An effect
    without a start in this record has no fit.
    """
    extended = bases[0].extended.attach(offer.effect, offer.scales, offer.balance)
    held = extended.shapes

    def error(candidate: Fit) -> float:
        return problem.seen_rmse(candidate.gap)

    starts = offer.effect.starts(offer.scales)
    if not starts:
        return []

    def glance(base: Fit, start: tuple[float, ...]) -> Fit:
        values = np.concatenate([base.values, start])
        return fit(
            problem,
            extended,
            extended.coordinates(values),
            iterations=_GLANCE_ITERATIONS,
            kept=base.jacobian,
            held=held,
        )

    glances = [(min((glance(base, start) for start in starts), key=error), base) for base in bases]
    glances.sort(key=lambda glance: error(glance[0]))
    promising = 1 if kept == 1 else kept + _MORE
    further = [
        fit(
            problem,
            extended,
            best.coordinates,
            iterations=_SCREEN_ITERATIONS,
            kept=base.jacobian,
            held=held,
        )
        for best, base in glances[:promising]
    ]
    if kept > 1:
        further.sort(key=error)
        further = [refine(problem, each, _SCREEN_ITERATIONS, held) for each in further[:kept]]
    return sorted((each for each in further if each.stable), key=error)


def refine(problem: Problem, screened: Fit, iterations: int, held: np.ndarray | None = None) -> Fit:
    """Continue a screened fit with a Jacobian of all parameters, or of all that are not held."""
    own = screened.extended.effect_slices[-1]
    known = int(np.sum(screened.extended.free < own.start))
    return fit(
        problem,
        screened.extended,
        screened.coordinates,
        iterations=iterations,
        slow=known,
        held=held,
    )


def in_parallel(task, items: Iterable, workers: int) -> list:
    """Apply ``task`` to each item on threads (the integrator releases the lock), in order."""
    items = list(items)
    if workers == 1:
        return [task(item) for item in items]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(task, items))
