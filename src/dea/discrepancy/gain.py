"""How much an effect narrows the gap on blocks it was not fitted on, and how sure that is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem

_DRAWS = 500
_NULL_DRAWS = 60


@dataclass(frozen=True)
class Gains:
    """Gains log(RMSE₀/RMSEₖ) over the chosen blocks, one per candidate.

    ``low`` and ``high`` bound all of them together with 95 % confidence; ``null`` is the gain
    that the best of them exceeds in 5 % of records that miss nothing.
    """

    gain: np.ndarray
    low: np.ndarray
    high: np.ndarray
    null: float


def energies(gap: np.ndarray, blocks: Sequence[slice]) -> np.ndarray:
    """Return the sum of squares of ``gap`` in each block."""
    return np.array([float(gap[block] @ gap[block]) for block in blocks])


def gains(
    before: np.ndarray,
    after: Sequence[np.ndarray],
    blocks: Sequence[slice],
    null: float,
    rng: np.random.Generator,
) -> Gains:
    """Compare gaps block by block; resample blocks in pairs, and bound the largest deviations.

    The bounds hold for the whole catalogue at once (max-T, Westfall and Young 1993). Either side
    has a reach of its own: where few blocks hold most of the gap, draws without them fall far
    below the gain, and none lies as far above it.
    """
    reference = energies(before, blocks)
    sums = np.array([energies(gap, blocks) for gap in after])
    picks = rng.integers(0, len(blocks), (_DRAWS, len(blocks)))
    gain = 0.5 * np.log(reference.sum() / sums.sum(1))
    drawn = 0.5 * np.log(reference[picks].sum(1) / sums[:, picks].sum(2))
    error = drawn.std(1) + 1e-12
    deviation = (drawn - gain[:, None]) / error[:, None]
    above = np.quantile(deviation.max(0), 0.975) * error
    below = np.quantile((-deviation).max(0), 0.975) * error
    return Gains(gain, gain - above, gain + below, null)


def coloured(gap: np.ndarray, blocks: Sequence[slice], order: int = 4) -> tuple[np.ndarray, float]:
    """Return autoregression and innovation deviation of ``gap`` (Yule-Walker over blocks)."""
    covariance = np.zeros(order + 1)
    count = 0
    for block in blocks:
        part = gap[block] - gap[block].mean()
        if part.size > 4 * order:
            covariance += [part[: part.size - lag] @ part[lag:] for lag in range(order + 1)]
            count += part.size
    if not count:
        return np.zeros(0), float(gap.std())
    covariance /= count
    toeplitz = covariance[np.abs(np.subtract.outer(np.arange(order), np.arange(order)))]
    weights = np.linalg.solve(toeplitz + 1e-9 * covariance[0] * np.eye(order), covariance[1:])
    return weights, float(np.sqrt(max(covariance[0] - weights @ covariance[1:], 0.0)))


def null_gain(
    problem: Problem,
    before: Fit,
    after: Sequence[Fit],
    noise: np.ndarray,
    blocks: Sequence[slice],
    rng: np.random.Generator,
) -> float:
    """Return the 95 % quantile of the best gain where nothing is missing.

    Records are drawn as the nominal simulation plus noise of the colour of ``noise``; each
    candidate is refitted to each of them by one Gauss-Newton step, at the shape it took.
    """
    from scipy.signal import lfilter

    weights, deviation = coloured(noise, blocks)
    draws = lfilter(
        [1.0], np.concatenate([[1.0], -weights]),
        deviation * rng.standard_normal((_NULL_DRAWS, problem.u.size)), axis=1,
    )  # fmt: skip

    def left_over(J: np.ndarray) -> np.ndarray:
        A = J[problem.fit]
        ridge = problem.noise**2 * np.eye(J.shape[1])
        steps = np.linalg.solve(A.T @ A + ridge, A.T @ draws[:, problem.fit].T)
        rest = draws[:, problem.select] - (J[problem.select] @ steps).T
        return np.einsum("ij,ij->i", rest, rest)

    reference = left_over(before.jacobian)
    best = np.zeros(_NULL_DRAWS)
    for candidate in after:
        best = np.maximum(best, 0.5 * np.log(reference / left_over(candidate.jacobian)))
    return float(np.quantile(best, 0.95))
