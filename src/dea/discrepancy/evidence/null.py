"""The gain that chance alone reaches in a record that misses nothing."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem

_DRAWS = 60


def coloured(
    residual: np.ndarray, blocks: Sequence[slice], order: int = 4
) -> tuple[np.ndarray, float]:
    """Return autoregression and innovation deviation of ``residual`` (Yule-Walker over blocks)."""
    covariance = np.zeros(order + 1)
    count = 0
    for block in blocks:
        part = residual[block] - residual[block].mean()
        if part.size > 4 * order:
            covariance += [part[: part.size - lag] @ part[lag:] for lag in range(order + 1)]
            count += part.size
    if not count:
        return np.zeros(0), float(residual.std())
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

    Records are drawn as the nominal simulation plus noise with the spectrum of ``noise`` (n,); each
    candidate is refitted to each of them by one Gauss-Newton step from its fitted parameters.
    """
    from scipy.signal import lfilter

    weights, deviation = coloured(noise, blocks)
    draws = lfilter(
        [1.0], np.concatenate([[1.0], -weights]),
        deviation * rng.standard_normal((_DRAWS, problem.size)), axis=1,
    )  # fmt: skip

    def left_over(J: np.ndarray) -> np.ndarray:
        A = J[problem.fit]
        ridge = problem.noise**2 * np.eye(J.shape[1])
        steps = np.linalg.solve(A.T @ A + ridge, A.T @ draws[:, problem.fit].T)
        rest = draws[:, problem.select] - (J[problem.select] @ steps).T
        result: np.ndarray = np.einsum("ij,ij->i", rest, rest)
        return result

    reference = left_over(before.jacobian)
    best = np.zeros(_DRAWS)
    for candidate in after:
        best = np.maximum(best, 0.5 * np.log(reference / left_over(candidate.jacobian)))
    return float(np.quantile(best, 0.95))
