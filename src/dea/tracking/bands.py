"""Where the bands of tracked parameters are taken, and when they are withheld."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.narx import NOT_WHITE, fit_autoregression

Array = NDArray[np.float64]

NOT_MOVED = (
    "no step of the free-run smoother lowered the error of the free run, so that this is the "
    "estimate of the {} instead"
)
NOT_SETTLED = (
    "the iteration over free runs did not settle: the parameters change too fast for its "
    "linearisation, or the record tells too little of them"
)
WINDOWS_FAILED = (
    "{} windows of the record have no estimate: the free run diverges, or outputs are missing"
)
TARGET_UNKNOWN = "leakage pulls towards parameters whose own covariance is not known"


class Estimate(NamedTuple):
    """What a tracker found, of the samples after the largest lag.

    ``theta`` and ``std`` (n, p), ``innovation`` (n,), ``covariance`` (k, p, p) at the instants,
    ``estimator`` the method that the estimate is of, and ``withheld`` why no interval holds.
    """

    theta: Array
    std: Array
    innovation: Array
    covariance: Array
    estimator: str
    withheld: str
    noise_ratio: Array | None = None


def instants(samples: int, count: int) -> NDArray[np.int64]:
    """Return ``count`` samples evenly spread, each in the middle of its share of the record.

    Every sample of a shorter record.
    """
    at = np.arange(min(count, samples))
    return at * samples // at.size + samples // (2 * at.size)


def reason_of_innovations(innovation: Array) -> str:
    """Return why intervals of an estimate by one-step errors do not hold, empty where they do."""
    # The first tenth holds the start from the prior.
    settled = innovation[innovation.size // 10 :]
    return NOT_WHITE if fit_autoregression([settled]).order else ""
