"""Fit every effect of the catalogue to a record, each with the same freedom and budget."""

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from dea.discrepancy.effects import Effect, Scales
from dea.discrepancy.extended import ExtendedSimulation
from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.problem import Problem

_SCREEN_ITERATIONS = 4
_FULL_ITERATIONS = 15


def extend(
    before: Fit, effect: Effect, scales: Scales, start: tuple[float, ...]
) -> tuple[ExtendedSimulation, np.ndarray]:
    """Return the simulation with ``effect`` attached, and the coordinates to fit it from."""
    extended = before.extended.attach(effect, scales)
    return extended, extended.coordinates(np.concatenate([before.values, start]))


def screen(problem: Problem, before: Fit, effect: Effect, scales: Scales) -> list[Fit]:
    """Fit an effect from each of its starts with a few cheap steps; best first.

    The Jacobian of the parameters that are there already is kept as it was at their optimum.
    """
    fits = []
    for start in effect.starts(scales):
        extended, coordinates = extend(before, effect, scales, start)
        fits.append(
            fit(problem, extended, coordinates, iterations=_SCREEN_ITERATIONS, kept=before.jacobian)
        )
    return sorted(fits, key=lambda f: f.cost)


def refine(problem: Problem, screened: Fit) -> Fit:
    """Finish a screened fit with the exact Jacobian."""
    return fit(problem, screened.extended, screened.coordinates, iterations=_FULL_ITERATIONS)


def in_parallel(task, items: Iterable, workers: int) -> list:
    """Apply ``task`` to each item on threads (the integrator releases the lock), in order."""
    items = list(items)
    if workers == 1:
        return [task(item) for item in items]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(task, items))
