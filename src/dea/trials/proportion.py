"""A share of trials and what so many trials say about it."""

from math import nan, sqrt
from typing import NamedTuple

_Z = 1.959963984540054  # of the standard normal distribution, 95 % between -z and z


class Proportion(NamedTuple):
    """A share with the 95 % interval of the probability behind it; NaN where ``count`` is zero."""

    value: float
    low: float
    high: float
    count: int


def wilson(successes: int, count: int) -> Proportion:
    """Return the share ``successes / count`` with Wilson's score interval.

    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209: the probabilities p for which the observed
    share is within z standard errors, taken at p.
    """
    if count == 0:
        return Proportion(nan, nan, nan, 0)
    share, z2 = successes / count, _Z**2
    centre = share + z2 / (2 * count)
    half = _Z * sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    shrink = 1 + z2 / count
    low = 0.0 if successes == 0 else (centre - half) / shrink
    high = 1.0 if successes == count else (centre + half) / shrink
    return Proportion(share, low, high, count)
