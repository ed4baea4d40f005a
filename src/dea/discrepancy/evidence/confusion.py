"""Which candidates this record could confuse."""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.sensitivity import unabsorbed
from dea.discrepancy.problem.problem import Problem


@dataclass(frozen=True)
class Confusion:
    """Candidates, and the probability (k, k) that each, if present, is taken for each other."""

    candidates: tuple[Candidate, ...]
    probability: np.ndarray


def confusion(problem: Problem, candidates: tuple[Candidate, ...]) -> Confusion:
    """Return the probability that candidate i, present at its fitted size, is taken for j.

    Each fitted simulation in turn is taken as the truth; every other one is refitted to it by a
    Gauss-Newton step, and its residual relative to the noise gives the probability that it fits a
    noisy record better. Rows sum to one.
    """
    from scipy.stats import norm

    seen = problem.seen
    fits = [c.fit for c in candidates]
    simulated = [(problem.y - fit.residual)[seen] for fit in fits]
    left = [unabsorbed(fit.jacobian[seen], problem.noise) for fit in fits]
    count = len(fits)
    distance = np.zeros((count, count))
    for i in range(count):
        for j in range(count):
            if i != j:
                rest = left[j](simulated[i] - simulated[j])
                distance[i, j] = np.linalg.norm(rest) / problem.noise
    odds = 2.0 * norm.cdf(-0.5 * distance)
    return Confusion(candidates, odds / odds.sum(1, keepdims=True))
