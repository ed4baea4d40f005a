"""Whether a residual is coloured noise and nothing else."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from dea.autoregression import fit_autoregression, innovations
from dea.discrepancy.evidence.null import long_parts
from dea.discrepancy.evidence.regression import part_predicted
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.evidence.unknown_force import unknown_force
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.inputs import by_input
from dea.missing import runs

# A flexible model of the residual that predicts more than this part of it has found a cause.
PREDICTED = 0.2
# Excess kurtosis of the innovations, and spread of the logarithms of their levels block by block,
# above which they do not come from one stationary source.
_KURTOSIS, _UNEVEN = 1.0, 0.35
# Lags at which signs are compared, the part of the samples that have another one so far ahead, and
# the probability with which white noise fails.
_SIGNS, _PAIRS, _CHANCE = 50, 0.2, 1e-3
# Lags of the input, up to this part of the record, and the weight of the ridge.
_LAGS, _LONGEST, _RIDGE = 24, 20, 1e-4


def is_coloured_noise(
    problem: Problem, residual: np.ndarray, blocks: Sequence[slice], most: float = PREDICTED
) -> bool:
    """Return whether a residual (n,) is stationary, Gaussian and follows from nothing known.

    An autoregression whitens it; what that leaves must be as large in every one of the
    ``blocks`` and without outliers, and at ``most`` this part of the residual may be predicted from
    input and motion.
    """
    parts = long_parts(residual, blocks)
    if len(parts) < 2:  # nothing says whether it is as large everywhere
        return False
    colour = fit_autoregression(parts)
    parts = [innovations(colour, part) for part in parts]
    left = np.concatenate(parts)
    kurtosis = float(np.mean((left - left.mean()) ** 4) / np.var(left) ** 2 - 3.0)
    levels = np.log([part.std() for part in parts])
    even = float(np.std(levels)) <= _UNEVEN
    return even and kurtosis <= _KURTOSIS and predictable(problem, residual) <= most


def leaves_coloured_noise(
    problem: Problem, fitted: Fit, blocks: Sequence[slice], most: float = PREDICTED
) -> bool:
    """Return whether what a fit leaves is coloured noise that no smooth force would cause."""
    return is_coloured_noise(problem, fitted.residual, blocks, most) and follows_no_force(
        problem, fitted, most
    )


def follows_no_force(problem: Problem, fitted: Fit, most: float = PREDICTED) -> bool:
    """Return whether no smooth force predicts more than a part of what a fit leaves."""
    force = unknown_force(problem, fitted)
    return force is None or force.part <= most


def is_white(problem: Problem, residual: np.ndarray) -> bool:
    """Return whether the signs of a residual (n,) follow one another at random where it is seen.

    Their autocorrelation at the first lags is tested (Ljung and Box 1978, Biometrika 65:297), which
    noise passes whose level changes.
    """
    signs = np.sign(residual - np.median(residual[problem.seen]))
    parts = [signs[run] for run in runs(problem.seen)]
    pairs = np.array([sum(max(part.size - k, 0) for part in parts) for k in range(1, _SIGNS + 1)])
    lags = 1 + np.flatnonzero(pairs > _PAIRS * problem.seen.sum())
    if not lags.size:
        return False
    products = [sum(float(part[k:] @ part[:-k]) for part in parts if part.size > k) for k in lags]
    statistic = np.sum(np.array(products) ** 2 / pairs[lags - 1])
    return bool(chi2.sf(statistic, lags.size) > _CHANCE)


def predictable(problem: Problem, residual: np.ndarray) -> float:
    """Return the part of a residual that input and motion predict on samples not fitted to."""
    flexible = 1.0 - residual_model(problem, residual).ratio
    return max(flexible, _follows_input(problem, residual))


def _follows_input(problem: Problem, residual: np.ndarray) -> float:
    """Return the part of a residual that a long moving average of every input predicts.

    A dynamic error of the simulation shows there, whatever its time constants.
    """
    X = np.column_stack([_past(u) for u in by_input(problem.u)])
    return part_predicted(problem, residual, X, (_RIDGE,))


def _past(u: np.ndarray) -> np.ndarray:
    """Return the lags of an input (n,), and what lies between them, as columns."""
    u = u - u.mean()
    lags = np.unique(np.round(np.geomspace(1, max(2, u.size // _LONGEST), _LAGS)).astype(int)) - 1
    X = np.column_stack([np.concatenate([np.zeros(k), u[: u.size - k]]) for k in lags])
    # Differences of running sums join the lags without leaving samples out between them.
    sums = np.cumsum(X, axis=0)
    return np.column_stack([X, np.diff(sums, axis=1)])
