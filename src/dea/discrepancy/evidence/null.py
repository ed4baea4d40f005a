"""The gain that chance alone reaches in a record that misses nothing."""

from collections.abc import Sequence

import numpy as np

from dea.autoregression import fit_autoregression
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem

_DRAWS = 60
_SHORTEST = 21  # samples of a block whose colour counts


def long_parts(residual: np.ndarray, blocks: Sequence[slice]) -> list[np.ndarray]:
    """Return the parts of a residual (n,) in ``blocks`` that show its colour, without their means.

    Blocks of fewer than 21 samples show none.
    """
    parts = [residual[block] for block in long_blocks(blocks)]
    return [part - part.mean() for part in parts]


def long_blocks(blocks: Sequence[slice]) -> list[slice]:
    """Return the blocks that show the colour of a residual."""
    return [block for block in blocks if block.stop - block.start >= _SHORTEST]


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

    colour = fit_autoregression(long_parts(noise, blocks) or [noise - noise.mean()])
    innovations = np.sqrt(colour.variance) * rng.standard_normal((_DRAWS, problem.size))
    draws = lfilter([1.0], colour.coefficients, innovations, axis=1)

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
