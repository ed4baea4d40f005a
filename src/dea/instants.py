"""Where along a record something that changes is looked at."""

import numpy as np

from dea.arrays import Indices


def evenly_spread(samples: int, count: int) -> Indices:
    """Return ``count`` samples evenly spread, each in the middle of its share of the record.

    Every sample of a shorter record.
    """
    at = np.arange(min(count, samples))
    return at * samples // at.size + samples // (2 * at.size)
