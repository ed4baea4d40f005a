"""The random-walk model of parameters, independent of the units of their regressors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.tracking.kalman import NOWHERE, Prior, Smoothed, fit_noise_ratio, smooth
from dea.tracking.unknown_ratios import covariance_with_unknown_ratios


@dataclass(frozen=True)
class RandomWalk:
    """The random walk of the parameters, for regressors scaled to a root mean square of one.

    Parameters
    ----------
    noise_ratio
        Variance of a parameter's step in one sample over that of the noise; one for all, or one
        each. None fits one for each by likelihood.
    prior_variance
        Variance of the parameters before the first sample over that of the noise.
    thinning
        Of the samples that the likelihood uses; see :func:`dea.tracking.kalman.fit_noise_ratio`.
    """

    noise_ratio: Array | None = None
    prior_variance: float = 1.0
    thinning: int = 10

    def smooth(
        self, Phi: Array, y: Array, theta_0: Array, at: NDArray[np.int64] = NOWHERE
    ) -> Smoothed:
        """Smooth ``y = Phi theta_t`` around ``theta_0``; the result is for the unscaled ``Phi``.

        The whole covariance is kept at the samples ``at``.
        """
        scale = root_mean_square(Phi)
        Phi = Phi / scale
        prior = Prior(theta_0 * scale, self.prior_variance)
        q = self.noise_ratio
        if q is None:
            q = fit_noise_ratio(Phi, y, prior, thinning=self.thinning)
        found = smooth(Phi, y, q, prior, at)
        return found._replace(
            theta=found.theta / scale,
            filtered=found.filtered / scale,
            variance=found.variance / scale**2,
            covariance=found.covariance / np.outer(scale, scale),
        )

    def covariance(
        self, Phi: Array, y: Array, theta_0: Array, found: Smoothed, at: NDArray[np.int64]
    ) -> Array:
        """Return the covariances (k, p, p) of what ``smooth`` found, at the same samples ``at``.

        Where it fitted the ratios, they hold what these leave open.
        """
        if self.noise_ratio is not None or not at.size:
            return found.covariance
        scale = root_mean_square(Phi)
        both = np.outer(scale, scale)
        scaled = found._replace(theta=found.theta * scale, covariance=found.covariance * both)
        prior = Prior(theta_0 * scale, self.prior_variance)
        covariance = covariance_with_unknown_ratios(
            Phi / scale, y, scaled, prior, thinning=self.thinning, at=at
        )
        return covariance / both


def root_mean_square(Phi: Array) -> Array:
    """Return the scale of each regressor; one for a regressor that is zero throughout."""
    scale = np.sqrt(np.mean(Phi**2, axis=0))
    return np.where(scale > 0.0, scale, 1.0)


def lead_in(rows: Array, count: int) -> Array:
    """Put ``count`` copies of the first row before the rows: samples before the first estimate."""
    return np.concatenate([np.repeat(rows[:1], count, axis=0), rows])
