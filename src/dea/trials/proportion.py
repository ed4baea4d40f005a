"""A share of trials and its confidence interval."""

from math import nan
from typing import NamedTuple


class Proportion(NamedTuple):
    """A share and the 95 % interval of the probability behind it; NaN without trials."""

    value: float
    low: float
    high: float
    trials: int


def wilson(successes: int, trials: int) -> Proportion:
    """Return the share ``successes / trials`` with Wilson's score interval.

    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
    """
    # Half a second to import, which the jobs that read scores do not need.
    from scipy.stats import binomtest

    if trials == 0:
        return Proportion(nan, nan, nan, 0)
    interval = binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    return Proportion(successes / trials, float(interval.low), float(interval.high), trials)
