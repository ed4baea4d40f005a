"""Fits of the simulation alone, which the candidates are compared with and start from."""

import numpy as np

from dea.discrepancy.fitting.fit import Fit, at, fit
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem, rmse
from dea.errors import InputError
from dea.simulation import ExtendedSimulation

_ITERATIONS = 30
# Distance (in prior spreads) from the refit beyond which another fit is a start of its own.
_FAR = 1.0
# Deviation of drawn starts (in prior spreads): far from the prior, a simulation often runs away.
_NEARER = 0.7
# Draws around the prior mean, at most, and the samples that may be simulated for them in all.
_DRAWS, _SHORT = 40, 10_000


def fit_nominal(
    problem: Problem,
    extended: ExtendedSimulation,
    count: int,
    rng: np.random.Generator,
    workers: int,
) -> Fit:
    """Refit the simulation from its prior mean and ``count`` - 1 draws around it; return the best.

    Raises
    ------
    InputError
        If the simulation is unstable wherever it is started from.
    """
    size = extended.layout.free.size
    starts = [np.zeros(size), *(_NEARER * rng.standard_normal((count - 1, size)))]
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
    """Fit with so large an assumed noise that the parameters stay near their prior.

    A refit spreads the residual that a missing effect causes over the whole record; in this fit
    it stays where the effect acts.
    """
    trust = rmse(refitted.residual, problem.seen) * np.sqrt(problem.seen.sum()) / 3.0
    start = np.zeros(refitted.coordinates.size)
    return fit(problem.with_noise(max(trust, problem.noise)), refitted.extended, start)


def fit_parts(problem: Problem, near: Fit) -> list[Fit]:
    """Fit the lower and the upper half of the output alone.

    An effect that acts at one end of the range, such as a limit or a threshold, is absent from
    the other half, so that the fit to that half estimates the parameters without bias.
    """
    middle = np.median(problem.y[problem.seen])
    parts = []
    for half in (problem.y <= middle, problem.y >= middle):
        fitted = fit(problem.seeing(half), near.extended, near.coordinates, iterations=_ITERATIONS)
        parts.append(at(problem, near.extended, fitted.coordinates))
    return parts


def bases(problem: Problem, nominal: Fit, near: Fit, rng: np.random.Generator) -> list[Fit]:
    """Return the fits to start candidates from: the refit first, and others that are far from it.

    Where an effect is missing, the parameters of the refit are biased, which makes it a bad
    start. The fit near the prior, the fits to one half of the output and the prior itself are
    others, and a short record affords draws around its mean as well.
    """
    size = nominal.coordinates.size
    draws = int(min(_DRAWS, _SHORT // problem.size))
    drawn = [at(problem, nominal.extended, x) for x in _NEARER * rng.standard_normal((draws, size))]
    others = [near, *fit_parts(problem, near)] if near.stable else []
    others.append(at(problem, nominal.extended, np.zeros(size)))
    far = [
        other
        for other in others
        if other.stable and np.linalg.norm(nominal.coordinates - other.coordinates) > _FAR
    ]
    return [nominal, *far, *(each for each in drawn if each.stable)]
