"""An explanation of a device: its simulation with effects, and what records tell of it."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.discrepancy import Fit, Problem, Samples, sensitivities
from dea.effect_label import joined
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
    root : (k, k)
        Lower triangular root of the covariance, which for a quiet sensor may not be positive
        definite once it is rounded.
    """

    extended: ExtendedSimulation
    mean: np.ndarray
    root: np.ndarray

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Its effects, with the force port of each where the simulation has several."""
        return tuple(sorted(self.extended.places.label(a) for a in self.extended.attached))

    @cached_property
    def name(self) -> str:
        """Its effects in one word; ``none`` for the simulation alone."""
        return joined(self.labels) or NONE

    @cached_property
    def effects(self) -> Counter[str]:
        """How often it holds each effect, by name: a stop may act at two places."""
        return Counter(a.effect.name for a in self.extended.attached)

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations (k,) of the coordinates."""
        lengths: np.ndarray = np.linalg.norm(self.root, axis=1)
        return lengths

    def simulated(self, u: np.ndarray, interval: float) -> np.ndarray:
        """Return the output (n,) that the mean predicts; NaN where it diverges."""
        return self.extended.simulate(self.extended.layout.values(self.mean), u, interval)

    def linearised(self, u: np.ndarray, interval: float) -> tuple[np.ndarray, np.ndarray]:
        """Return that output, which must not diverge, and its derivative (n, k) by coordinates."""
        problem = as_problem(Samples(u, np.zeros(u.size), interval))
        residual = problem.residual(self.extended, self.extended.layout.values(self.mean))
        every = np.arange(self.mean.size)
        J = sensitivities(problem, self.extended, self.mean, residual, every)
        return -residual, -J

    def informed(self, mean: np.ndarray, slope: np.ndarray) -> "Explanation":
        """Return it with what a further record told, whose own coordinates are forgotten.

        With the ``slope`` S (n, k) of all that was minimised, SᵀS is the precision.
        """
        own = self.extended.layout.own_of_records
        apart = _inverse(triangle(slope))
        root = np.eye(mean.size)
        root[np.ix_(~own, ~own)] = _lower(apart[~own])
        return Explanation(self.extended, np.where(own, 0.0, mean), root)


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
    50:1, with the prior's share). No product with a transpose is formed, which would square the
    condition.
    """
    joint = fitted.extended
    alone = joint.alone
    J = np.where(problem.seen[:, None], fitted.jacobian, 0.0) / problem.noise
    prior = np.eye(fitted.coordinates.size)
    spreads = [error.spread(J[part]) / problem.noise for part in fitted.records]
    scatter = triangle(np.vstack([*spreads, prior]))
    inverse = _inverse(triangle(np.vstack([J, prior])))
    joint_root = inverse @ (inverse.T @ scatter.T)
    own = joint.layout.own_of_records
    places = {joint.layout.names[i]: k for k, i in enumerate(joint.layout.free) if not own[k]}
    kept = [k for k, i in enumerate(alone.layout.free) if alone.layout.names[i] in places]
    of_joint = [places[alone.layout.names[alone.layout.free[k]]] for k in kept]
    mean, root = np.zeros(alone.layout.free.size), np.eye(alone.layout.free.size)
    mean[kept] = fitted.coordinates[of_joint]
    root[np.ix_(kept, kept)] = _lower(joint_root[of_joint])
    low, high = alone.layout.bounds
    return Explanation(alone.as_recorded, np.clip(mean, low, high), root)


def triangle(matrix: np.ndarray) -> np.ndarray:
    """Return the upper triangular R (k, k) with RᵀR = XᵀX of a matrix X (n, k)."""
    return np.linalg.qr(matrix)[1]


def _inverse(upper: np.ndarray) -> np.ndarray:
    """Return the inverse of an upper triangular matrix (k, k)."""
    from scipy.linalg import solve_triangular

    result: np.ndarray = solve_triangular(upper, np.eye(len(upper)))
    return result


def _lower(root: np.ndarray) -> np.ndarray:
    """Return the lower triangular root (m, m) of what any ``root`` (m, k) is one of."""
    return triangle(root.T).T
