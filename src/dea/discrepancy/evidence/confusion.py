"""Can this record tell two effects apart? Rivals in pairs, and the record's confusion matrix."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.evidence.gain import energies
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import unabsorbed

_DRAWS = 500


def beaten(
    best: np.ndarray, rival: np.ndarray, blocks: Sequence[slice], rng: np.random.Generator
) -> tuple[float, float]:
    """Return how much larger the rival's RMSE is (log ratio), and its lower 95 % bound.

    Blocks are resampled in pairs, so that what both leave over cancels.
    """
    a, b = energies(best, blocks), energies(rival, blocks)
    picks = rng.integers(0, len(blocks), (_DRAWS, len(blocks)))
    drawn = 0.5 * np.log(b[picks].sum(1) / a[picks].sum(1))
    return 0.5 * float(np.log(b.sum() / a.sum())), float(np.quantile(drawn, 0.05))


def confusion(problem: Problem, fits: Sequence[Fit]) -> np.ndarray:
    """Return the probability that effect i, present at its fitted size, is called effect j.

    Each fitted simulation is rerun as if it were the truth; every other one is refitted to it by
    a Gauss-Newton step, and what it leaves over against the noise gives the probability that it
    fits a noisy record better. Rows sum to one.
    """
    from scipy.stats import norm

    seen = problem.seen
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
    return odds / odds.sum(1, keepdims=True)
