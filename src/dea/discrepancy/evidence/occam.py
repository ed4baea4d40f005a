"""How much the freedom of an explanation counts against it before the record is looked at.

A flexible law is penalised by the part of its prior that the record leaves to it (Laplace's
approximation: MacKay 1992, Neural Computation 4:415). Most of a law's parameters only shape it, and
rarely does a device need all of them: a law stands for several laws, in each of which some shapes
are as expected (a prior of spike and slab: Mitchell and Beauchamp 1988, JASA 83:1023). Their
evidence is summed, so that a law is hardly penalised for what it could do besides.
"""

from collections.abc import Sequence
from functools import cache
from math import comb, log, log1p
from typing import NamedTuple

import numpy as np

from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit

_Shapes = frozenset[int]


def log_prior(candidates: Sequence[Candidate], offered: int, at_bound: float) -> np.ndarray:
    """Return log prior odds (k,) of candidates against the simulation alone.

    A set of k of the ``offered`` effects has the probability that all sets of its size share, and
    each of the force ports that it can act at a part of that. Each parameter at its bound costs
    ``at_bound``, as it counts against the law it belongs to.
    """

    def sets(c: Candidate) -> int:
        return comb(max(offered, 1), min(len(c.effects), offered)) * c.places

    return np.array([-log(sets(c)) - at_bound * len(c.at_bounds) for c in candidates])


def log_volume(fitted: Fit, samples: np.ndarray, density: float, shaped: float) -> float:
    """Return the log of the part of its prior that a record leaves to a fit.

    Parameters
    ----------
    samples : (n,) bool
        Those that determine the parameters.
    density
        Variance of their error.
    shaped
        Probability that a shape of a law is not at its prior mean. A shape held at its prior mean
        has no freedom, but the error of the fit without it, by a linear step, counts. The evidence
        of the best choice of free shapes, and of those that differ from it in one, is summed.
    """
    J = fitted.jacobian[samples] / np.sqrt(max(density, 1e-300))
    r = fitted.residual[samples] / np.sqrt(max(density, 1e-300))
    told = _Told(fitted.coordinates, J.T @ J, J.T @ r)
    shapes: list[int] = np.flatnonzero(fitted.extended.layout.shapes).tolist()

    @cache
    def volume(expected: _Shapes) -> float:
        other = len(shapes) - len(expected)
        return told.log_volume(expected) + len(expected) * log1p(-shaped) + other * log(shaped)

    expected: _Shapes = frozenset()
    best = volume(expected)
    while rest := [expected | {shape} for shape in shapes if shape not in expected]:
        found, more = max(((volume(some), some) for some in rest), key=lambda pair: pair[0])
        if found <= best:
            break
        best, expected = found, more
    # For a shape that the record does not determine, both choices have the same evidence.
    beside = [volume(expected ^ {shape}) - best for shape in shapes]
    return best + float(np.log1p(np.exp(beside)).sum())


class _Told(NamedTuple):
    """What a record tells of the coordinates ``x`` (k,) of a fit, where it errs linearly in them.

    ``A`` (k, k) is the information, ``slope`` (k,) that of the negative log likelihood.
    """

    x: np.ndarray
    A: np.ndarray
    slope: np.ndarray

    def log_volume(self, expected: _Shapes) -> float:
        """Return the volume with some of the coordinates at their prior means.

        Each direction that is told costs the log of the ratio of its prior and posterior
        deviations, besides the distance of the estimate from the prior. That distance counts as by
        Cauchy's distribution: a spread says what is usual, and a delay of twenty spreads is
        unusual, but not impossible.
        """
        x, A = self.x, self.A
        free = np.array([i for i in range(x.size) if i not in expected], int)
        moved, worse = x.copy(), 0.0
        if expected:
            held = np.array(sorted(expected), int)
            moved[held] = 0.0
            P = A + np.eye(x.size)
            change = P[np.ix_(free, held)] @ x[held]
            moved[free] += np.linalg.lstsq(P[np.ix_(free, free)], change, rcond=None)[0]
            step = moved - x
            worse = float(0.5 * step @ A @ step + self.slope @ step)
        directions = np.maximum(np.linalg.eigvalsh(A[np.ix_(free, free)]), 0.0)
        # Exact in the limits of no and of much information: Cauchy's density at its mode is 1 / pi.
        width = np.log1p(0.5 * np.pi * directions)
        return -float(np.log1p(moved[free] ** 2).sum() + 0.5 * width.sum()) - worse
