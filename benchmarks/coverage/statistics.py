"""Coverage with an interval that allows for what points of one record have in common."""

from dataclasses import dataclass

import numpy as np

from benchmarks.coverage.plants import Array

Z = 1.959964


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
    ones with the variance that the records' shares show (Kish's effective size), between the number
    of records with a point and the number of points; the interval is Wilson's for it.
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
        # Of a ratio of sums over clusters.
        difference = np.nansum(inside, axis=1) - share * weight
        variance = records / (records - 1) * float(difference @ difference) / points**2
        if variance > 0:
            effective = share * (1 - share) / variance
    effective = min(max(effective, records / 4), points)
    low, high = wilson(share, effective)
    return Coverage(share, low, high, records, points)


def wilson(share: float, trials: float) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share of ``trials``."""
    centre = (share + Z**2 / (2 * trials)) / (1 + Z**2 / trials)
    half = Z * np.sqrt(share * (1 - share) / trials + Z**2 / (4 * trials**2)) / (1 + Z**2 / trials)
    return float(centre - half), float(centre + half)
