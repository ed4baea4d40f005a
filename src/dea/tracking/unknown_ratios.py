"""The covariance of smoothed parameters whose noise ratios are not known but estimated.

The ratios of largest likelihood are taken for known by the smoother. A record tells little of them:
the most likely one is often zero where the parameter does walk (the pile-up of N. Shephard and
A. C. Harvey, J. Time Ser. Anal. 11, 1990), and intervals that rest on it are too narrow. With a
ratio q_j unknown, the law of total variance adds

    E[C(q_j)] - C(q) + E[(theta(q_j) - theta(q)) (theta(q_j) - theta(q))^T]

over its posterior, the others at their estimates (J. D. Hamilton, J. Econometrics 33, 1986). The
standard deviation of a step has a uniform prior (A. Gelman, Bayesian Analysis 1, 2006).
"""

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.tracking.kalman import HIGHEST_RATIO, Prior, Smoothed, likelihood, smooth, thinned

_NODES = 12  # ratios of a parameter that its posterior is taken over
_COMMON_NODES = 48  # those of a common one, which costs no smoothing
_LEAST = 0.01  # share of the posterior of a ratio that is followed


def covariance_with_unknown_ratios(
    Phi: Array,
    y: Array,
    found: Smoothed,
    prior: Prior,
    *,
    thinning: int,
    at: NDArray[np.int64],
) -> Array:
    """Return the covariances (k, p, p) at the samples ``at`` with what each ratio leaves open.

    Parameters
    ----------
    Phi, y
        Regressors (n, p), of a root mean square of one, and outputs (n,), NaN where missing.
    found
        The estimate with the ratios of largest likelihood, its covariance at ``at``.
    prior, thinning
        As in :func:`dea.tracking.kalman.smooth` and :func:`dea.tracking.kalman.fit_noise_ratio`.
    """
    nodes, prior_mass = _nodes(y.size, _NODES)
    few = thinned(Phi, y, thinning)
    covariance: Array = found.covariance.copy()
    for ratios in _varied(found.noise_ratio, nodes):
        weight = _posterior(few, thinning * ratios, prior_mass, prior)
        for k in np.flatnonzero(weight > _LEAST):
            other = smooth(Phi, y, ratios[k], prior, at)
            moved = (other.theta - found.theta)[at]
            spread = moved[:, :, None] * moved[:, None, :]
            covariance += weight[k] * (other.covariance - found.covariance + spread)
    return covariance


def mean_common_ratio(Phi: Array, y: Array, prior: Prior, *, thinning: int) -> float:
    """Return the mean of the one noise ratio of all parameters over its posterior.

    Parameters are those of :func:`covariance_with_unknown_ratios`.
    """
    nodes, prior_mass = _nodes(y.size, _COMMON_NODES)
    ratios = np.tile(nodes[:, None], Phi.shape[1])
    weight = _posterior(thinned(Phi, y, thinning), thinning * ratios, prior_mass, prior)
    return float(weight @ nodes)


def _nodes(samples: int, count: int) -> tuple[Array, Array]:
    """Return ``count`` ratios at which a posterior is taken, and their shares of the prior.

    With a smaller one a parameter walks less in the record than the record can tell.
    """
    edges = np.geomspace(1.0 / max(samples, 100) ** 2, HIGHEST_RATIO, count + 1)
    return np.sqrt(edges[:-1] * edges[1:]), np.diff(np.sqrt(edges))


def _posterior(
    equations: tuple[Array, Array], ratios: Array, prior_mass: Array, prior: Prior
) -> Array:
    """Return the share of the posterior of each row of ``ratios`` (nodes, p)."""
    log_weight = np.array([likelihood(*equations, q, prior) for q in ratios])
    weight = np.exp(log_weight - log_weight.max()) * prior_mass
    share: Array = weight / weight.sum()
    return share


def _varied(noise_ratio: Array, nodes: Array) -> list[Array]:
    """Return for each parameter the ratios (nodes, p) with its own at every node."""
    varied = []
    for j in range(noise_ratio.size):
        ratios = np.tile(noise_ratio, (nodes.size, 1))
        ratios[:, j] = nodes
        varied.append(ratios)
    return varied
