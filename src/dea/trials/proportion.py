"""A share of trials and what so many trials say about it."""

from math import nan, sqrt
from typing import NamedTuple

_Z = 1.959963984540054  # of the standard normal distribution, 95 % between -z and z


class Proportion(NamedTuple):
    """A share and the 95 % interval of the probability behind it; NaN where there are no trials."""

    value: float
    low: float
    high: float
    trials: int


def wilson(successes: int, trials: int) -> Proportion:
    """Return the share ``successes / trials`` with Wilson's score interval.

    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209: the probabilities p for which the observed
    share is within z standard errors, taken at p.
    """
    if trials == 0:
        return Proportion(nan, nan, nan, 0)
    share, z2 = successes / trials, _Z**2
    centre = share + z2 / (2 * trials)
    half = _Z * sqrt(share * (1 - share) / trials + z2 / (4 * trials**2))
    shrink = 1 + z2 / trials
    low = 0.0 if successes == 0 else (centre - half) / shrink
    high = 1.0 if successes == trials else (centre + half) / shrink
    return Proportion(share, low, high, trials)
