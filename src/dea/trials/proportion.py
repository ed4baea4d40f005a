"""A share of trials and its confidence interval."""

from math import nan, sqrt
from typing import NamedTuple

from dea.confidence import DEVIATIONS as Z


class Proportion(NamedTuple):
    """A share and the 95 % interval of the probability behind it; NaN without trials."""

    value: float
    low: float
    high: float
    trials: float


def wilson(successes: float, trials: float) -> Proportion:
    """Return the share ``successes / trials`` with Wilson's score interval.

    Of dependent trials both are numbers of independent ones, and need not be whole:
    ``scipy.stats.binomtest``, whose interval is the same, takes whole numbers alone.

    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
    """
    if trials == 0:
        return Proportion(nan, nan, nan, 0)
    share = successes / trials
    scale = 1.0 + Z**2 / trials
    centre = (share + Z**2 / (2.0 * trials)) / scale
    half = Z * sqrt(share * (1.0 - share) / trials + Z**2 / (4.0 * trials**2)) / scale
    # Rounding must not leave a share of 0 or 1 outside of its interval.
    low, high = max(centre - half, 0.0), min(centre + half, 1.0)
    return Proportion(share, min(low, share), max(high, share), trials)
