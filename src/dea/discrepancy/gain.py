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
    """Compare gaps block by block; resample blocks in pairs, and bound the largest deviation.

    The bounds hold for the whole catalogue at once (max-T, Westfall and Young 1993). Every draw is
    measured by its own standard error (bootstrap-t, Efron and Tibshirani 1993, section 12.5): where
    few blocks hold most of the gap, the spread of the draws alone would promise too much.
    """
    reference = energies(before, blocks)
    sums = np.array([energies(gap, blocks) for gap in after])
    picks = rng.integers(0, len(blocks), (_DRAWS, len(blocks)))
    gain, error = _ratio(reference, sums)
    drawn, drawn_error = _ratio(reference[picks], sums[:, picks])
    largest = np.max(np.abs(drawn - gain[:, None]) / drawn_error, axis=0)
    reach = np.quantile(largest, 0.95) * error
    return Gains(gain, gain - reach, gain + reach, null)


def _ratio(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the log ratio of the sums over the last axis, halved, and its standard error."""
    total_before, total_after = before.sum(-1, keepdims=True), after.sum(-1, keepdims=True)
    influence = 0.5 * (before / total_before - after / total_after)
    blocks = before.shape[-1]
    error = np.sqrt(np.sum(influence**2, axis=-1) * blocks / (blocks - 1))
    return 0.5 * np.log(total_before / total_after)[..., 0], error + 1e-9


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
