"""Coverage with an interval that allows for what points of one record have in common."""

from dataclasses import dataclass

import numpy as np

from dea.arrays import Array
from dea.trials import wilson


@dataclass(frozen=True)
class Coverage:
    """Share of points inside their band, with a 95 % interval."""

    share: float
    low: float
    high: float
    records: int
    points: int


def coverage(inside: Array) -> Coverage:
    """Return the coverage of ``inside``, shape (records, points), 1 inside, 0 outside, or missing.

    The points of one record are no independent trials. The number of trials is that of independent
    ones with the variance that the records' shares show (Kish's effective size), at most the number
    of points, and at least a quarter of the number of records with a point, since some weigh more
    than others; the interval is Wilson's for it. Few points outside say little about how far those
    of a record agree: the interval reaches at least as far towards a half as that of records that
    are all inside as a whole.
    """
    known = ~np.isnan(inside)
    inside = inside[known.any(axis=1)]
    if not inside.size:
        return Coverage(np.nan, np.nan, np.nan, 0, 0)
    points = int(known.sum())
    weight = (~np.isnan(inside)).sum(axis=1)
    share = float(np.nansum(inside) / points)
    records = len(inside)
    effective = float(records)  # where all agree, since samples of a record are dependent
    if records > 1 and 0 < share < 1:
        # The variance of a ratio of sums over clusters.
        difference = np.nansum(inside, axis=1) - share * weight
        variance = records / (records - 1) * float(difference @ difference) / points**2
        effective = share * (1 - share) / variance if variance > 0 else float(points)
    effective = min(max(effective, records / 4), points)
    found, agreed = wilson(share * effective, effective), wilson(records, records)
    low, high = min(found.low, agreed.low), max(found.high, 1.0 - agreed.low)
    return Coverage(share, low, high, records, points)
