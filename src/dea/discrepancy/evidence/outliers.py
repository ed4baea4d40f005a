"""Single samples that lie far from their neighbours, as a sensor or a logger makes them."""

import numpy as np
from scipy.stats import median_abs_deviation

# Standard deviations from which a sample is one.
_FAR = 8.0
# An outlier also moves its two neighbours away from the means of theirs, by half of its distance:
# the least and the largest part that counts as half.
_ECHO = 0.25, 0.75


def count_outliers(residual: np.ndarray, measured: np.ndarray, noise: float) -> int:
    """Return how many single samples of a ``residual`` (n,) are outliers.

    Each ``measured`` (n, bool) sample is compared with the mean of its neighbours, which a slow
    residual hardly moves, by the median of the absolute distances (Hampel 1974, Journal of the
    American Statistical Association 69:383), and by the standard deviation of the ``noise``, below
    which quantised readings may scatter. A step moves two samples alike, and is none.
    """
    distance = residual[1:-1] - 0.5 * (residual[:-2] + residual[2:])
    known = measured[1:-1] & measured[:-2] & measured[2:]
    if np.count_nonzero(known) < 3:
        return 0
    scatter = float(median_abs_deviation(distance[known], scale="normal"))
    middle, before, after = distance[1:-1], distance[:-2], distance[2:]
    far = np.abs(middle) > _FAR * max(scatter, noise)
    there = known[1:-1] & known[:-2] & known[2:] & far
    low, high = _ECHO
    with np.errstate(divide="ignore", invalid="ignore"):
        for beside in (-before / middle, -after / middle):
            there &= (low < beside) & (beside < high)
    return int(np.count_nonzero(there))
