"""Fits of the simulation alone, which the candidates are compared with and start from."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.fit import Columns, Fit, at, fit
from dea.discrepancy.parallel import in_parallel
from dea.discrepancy.problem import Problem, rmse
from dea.errors import InputError
from dea.simulation import ExtendedSimulation

_ITERATIONS = 30
# Distance (in prior spreads) from the refit beyond which another fit is a start of its own.
_FAR = 1.0
# Draws of the prior, at most, and the samples that may be simulated for them in all.
_DRAWS, _SHORT = 40, 10_000


def fit_nominal(
    problem: Problem,
    extended: ExtendedSimulation,
    count: int,
    rng: np.random.Generator,
    workers: int,
) -> Fit:
    """Refit the simulation from ``count`` starts, its prior and draws of it; return the best.

    Raises
    ------
    InputError
        If the simulation is unstable wherever it is started from.
    """
    size = extended.free.size
    starts = [np.zeros(size), *(0.7 * rng.standard_normal((count - 1, size)))]
    fits = in_parallel(
        lambda start: fit(problem, extended, start, iterations=_ITERATIONS), starts, workers
    )
    best = min(fits, key=lambda f: f.cost)
    if not best.stable:
        raise InputError(
            "it runs away from every starting point",
            file=extended.simulation.source or f"simulation {extended.simulation.name}",
            field="parameters",
            remedy="Correct the nominal values, or the units of the record's input",
        )
    return best


def fit_near_prior(problem: Problem, refitted: Fit) -> Fit:
    """Fit with so large an assumed noise that the simulation's parameters stay near their prior.

    A refit spreads the residual that a missing effect causes over the whole record; in this fit
    it stays where the effect acts. Effects that are attached keep their parameters.
    """
    left = rmse(refitted.residual, problem.seen)
    doubt = max(left * np.sqrt(problem.seen.sum()) / 3.0, problem.noise)
    extended = refitted.extended
    held = Columns(held=extended.of_laws)
    near = fit(problem.with_noise(doubt), extended, refitted.at_prior_means, columns=held)
    # Columns that were held are zero, and the cost is that of another noise.
    return at(problem, extended, near.coordinates)


def bases_beside(problem: Problem, found: Fit) -> list[Fit]:
    """Return the fits to start a further effect from: that of the effects found so far first.

    Then the same laws with the simulation near its prior, if that is far from it: its parameters
    may have moved to make up for the effect that is still missing.
    """
    return [found, *_far_from(found, [fit_near_prior(problem, found)])]


def _far_from(refitted: Fit, others: Sequence[Fit]) -> list[Fit]:
    return [
        other
        for other in others
        if other.stable and np.linalg.norm(refitted.coordinates - other.coordinates) > _FAR
    ]


def fit_parts(problem: Problem, near: Fit) -> list[Fit]:
    """Fit the lower and the upper half of the output alone.

    An effect that acts at one end of the range, such as a limit or a threshold, is absent from
    the other half, so that the fit to that half estimates the parameters without bias.
    """
    middle = np.median(problem.y)
    parts = []
    for half in (problem.y <= middle, problem.y >= middle):
        fitted = fit(problem.seeing(half), near.extended, near.coordinates, iterations=_ITERATIONS)
        parts.append(at(problem, near.extended, fitted.coordinates))
    return parts


def bases(problem: Problem, nominal: Fit, near: Fit, rng: np.random.Generator) -> list[Fit]:
    """Return the fits to start candidates from: the refit first, and others that are far from it.

    Where an effect is missing, the parameters of the refit are biased, which makes it a bad
    start. The fit near the prior, the fits to one half of the output and the prior itself are
    others, and a short record affords draws of the prior as well.
    """
    size = nominal.coordinates.size
    draws = int(min(_DRAWS, _SHORT // problem.size))
    drawn = [at(problem, nominal.extended, x) for x in 0.7 * rng.standard_normal((draws, size))]
    others = [near, *fit_parts(problem, near)] if near.stable else []
    others.append(at(problem, nominal.extended, np.zeros(size)))
    return [nominal, *_far_from(nominal, others), *(each for each in drawn if each.stable)]
