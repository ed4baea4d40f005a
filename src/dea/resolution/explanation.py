"""An explanation of a device: its simulation with effects, and what records tell of it."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.discrepancy import Fit, Problem, Samples, sensitivities
from dea.missing import filled
from dea.resolution.error import Error
from dea.simulation import ExtendedSimulation

NONE = "none"


@dataclass(frozen=True, eq=False)
class Explanation:
    """A simulation of one further record, and the Gaussian belief in its free coordinates.

    Coordinates of one record alone (its start, a drift) have their prior; the others have their
    posterior from the records so far.

    Parameters
    ----------
    mean : (k,)
    covariance : (k, k)
    """

    extended: ExtendedSimulation
    mean: np.ndarray
    covariance: np.ndarray

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Its effects, with the force port of each where the simulation has several."""
        return tuple(sorted(self.extended.label(a) for a in self.extended.attached))

    @cached_property
    def name(self) -> str:
        """Its effects in one word; ``none`` for the simulation alone."""
        return "+".join(self.labels) or NONE

    @cached_property
    def effects(self) -> Counter[str]:
        """How often it holds each effect, by name: a stop may act at two places."""
        return Counter(a.effect.name for a in self.extended.attached)

    @cached_property
    def root(self) -> np.ndarray:
        """Lower triangular root (k, k) of the covariance."""
        return np.linalg.cholesky(self.covariance)

    def simulated(self, u: np.ndarray, interval: float) -> np.ndarray:
        """Return the output (n,) that the mean predicts; NaN where it diverges."""
        return self.extended.simulate(self.extended.values(self.mean), u, interval)

    def linearised(self, u: np.ndarray, interval: float) -> tuple[np.ndarray, np.ndarray]:
        """Return that output, which must not diverge, and its derivative (n, k) by coordinates."""
        problem = as_problem(Samples(u, np.zeros(u.size), interval))
        residual = problem.residual(self.extended, self.extended.values(self.mean))
        every = np.arange(self.mean.size)
        J = sensitivities(problem, self.extended, self.mean, residual, every)
        return -residual, -J

    def informed(self, mean: np.ndarray, precision: np.ndarray) -> "Explanation":
        """Return it with what a further record told, whose own coordinates are forgotten."""
        own = self.extended.own_of_records
        shared = np.ix_(~own, ~own)
        covariance = np.eye(mean.size)
        covariance[shared] = np.linalg.inv(precision)[shared]
        return Explanation(self.extended, np.where(own, 0.0, mean), covariance)


def as_problem(record: Samples) -> Problem:
    """Return a record of which every sample is seen."""
    y, measured = filled(record.y)
    nothing = np.zeros(y.size, bool)
    return Problem(record.u, y, record.interval, measured, nothing, nothing, measured=measured)


def explanation_of(fitted: Fit, problem: Problem, error: Error) -> Explanation:
    """Return the explanation that a fit to one record, or several, amounts to.

    The fit takes the noise for white, and sees a part of the samples. With its Jacobian J there in
    units of that noise, A = JᵀJ + I, and the covariance Ω of the ``error`` of each record in the
    same units, the covariance of its coordinates is A⁻¹ (JᵀΩJ + I) A⁻¹ (White 1982, Econometrica
    50:1, with the prior's share).
    """
    joint = fitted.extended
    alone = joint.alone
    J = np.where(problem.seen[:, None], fitted.jacobian, 0.0) / problem.noise
    curvature = J.T @ J + np.eye(fitted.coordinates.size)
    scatter = np.eye(fitted.coordinates.size)
    for part in fitted.records:
        spread = error.spread(J[part]) / problem.noise
        scatter += spread.T @ spread
    joint_covariance = np.linalg.solve(curvature, np.linalg.solve(curvature, scatter).T)
    own = joint.own_of_records
    places = {joint.names[i]: k for k, i in enumerate(joint.free) if not own[k]}
    kept = [k for k, i in enumerate(alone.free) if alone.names[i] in places]
    of_joint = [places[alone.names[alone.free[k]]] for k in kept]
    mean, covariance = np.zeros(alone.free.size), np.eye(alone.free.size)
    mean[kept] = fitted.coordinates[of_joint]
    covariance[np.ix_(kept, kept)] = joint_covariance[np.ix_(of_joint, of_joint)]
    low, high = alone.bounds
    return Explanation(alone.as_recorded, np.clip(mean, low, high), covariance)
