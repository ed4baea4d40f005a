"""Fit every effect of the catalogue to a record, each with the same freedom and budget."""

from collections.abc import Iterable
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


def screen(problem: Problem, before: Fit, offer: Offer) -> Fit | None:
    """Fit an effect by a few cheap steps; ``None`` if it has no start in this record.

    One step from each of its starts tells the best of them, which goes on. The Jacobian of the
    parameters that are there already is kept as it was at their optimum.
    """
    extended = before.extended.attach(offer.effect, offer.scales, offer.balance)
    glances = [
        fit(
            problem,
            extended,
            extended.coordinates(np.concatenate([before.values, start])),
            iterations=_GLANCE_ITERATIONS,
            kept=before.jacobian,
        )
        for start in offer.effect.starts(offer.scales)
    ]
    if not glances:
        return None
    best = min(glances, key=lambda f: f.cost)
    return fit(
        problem, extended, best.coordinates, iterations=_SCREEN_ITERATIONS, kept=before.jacobian
    )


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
