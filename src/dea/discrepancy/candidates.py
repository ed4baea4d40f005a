"""Fit every effect of the catalogue to a record, each with the same freedom and budget."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.effects import Effect, Scales
from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.problem import Problem

_GLANCE_ITERATIONS, _SCREEN_ITERATIONS = 1, 4


@dataclass(frozen=True)
class Offer:
    """An effect, where it would attach, and the scales it is told."""

    effect: Effect
    scales: Scales
    balance: int = 0


def screen(problem: Problem, bases: Sequence[Fit], offer: Offer, kept: int) -> Fit | None:
    """Fit an effect by a few cheap steps; ``None`` if it has no start in this record.

    One step from each of its starts on each of the ``bases`` (fits of the same simulation) tells
    the ``kept`` best of them, which go on until one is best. The Jacobian of the parameters that
    are there already is kept as it was in its base.
    """
    extended = bases[0].extended.attach(offer.effect, offer.scales, offer.balance)
    glances = [
        (
            fit(
                problem,
                extended,
                extended.coordinates(np.concatenate([base.values, start])),
                iterations=_GLANCE_ITERATIONS,
                kept=base.jacobian,
            ),
            base,
        )
        for base in bases
        for start in offer.effect.starts(offer.scales)
    ]
    if not glances:
        return None
    glances.sort(key=lambda glance: glance[0].cost)
    further = [
        fit(problem, extended, best.coordinates, iterations=_SCREEN_ITERATIONS, kept=base.jacobian)
        for best, base in glances[:kept]
    ]
    if kept > 1:
        further = [refine(problem, each, _SCREEN_ITERATIONS) for each in further]
    return min(further, key=lambda f: f.cost)


def refine(problem: Problem, screened: Fit, iterations: int) -> Fit:
    """Continue a screened fit with a Jacobian of all parameters."""
    own = screened.extended.effect_slices[-1]
    known = int(np.sum(screened.extended.free < own.start))
    return fit(problem, screened.extended, screened.coordinates, iterations=iterations, slow=known)


def in_parallel(task, items: Iterable, workers: int) -> list:
    """Apply ``task`` to each item on threads (the integrator releases the lock), in order."""
    items = list(items)
    if workers == 1:
        return [task(item) for item in items]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(task, items))
