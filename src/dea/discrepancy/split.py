"""Split a record into contiguous blocks: to fit on, to choose by, and to certify on, once."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dea.errors import InputError

# Fitting and choosing alternate, so that what changes with time, or shows only now and then, is
# seen by both; the certified block lies inside the record, where a drift can be interpolated.
_ALTERNATING = (("fit", 1), ("select", 1)) * 4
# Each pattern of (role, weight), and its shortest block in gaps; the first that fits is used.
_PATTERNS = (
    ((*_ALTERNATING, ("fit", 1), ("certify", 3), *_ALTERNATING, ("fit", 1)), 3.0),
    ((("fit", 2), ("select", 2), ("fit", 2), ("select", 2), ("fit", 2), ("certify", 3), ("fit", 2),
      ("select", 2), ("fit", 2)), 1.0),
    ((("fit", 3), ("select", 2), ("certify", 2), ("fit", 3)), 1.0),
)  # fmt: skip
_GAP_IN_TIME_CONSTANTS = 3.0


@dataclass(frozen=True)
class Split:
    """Masks over the samples of a record, and the gap (samples) between blocks."""

    fit: np.ndarray
    select: np.ndarray
    certify: np.ndarray
    gap: int

    def blocks(self, mask: np.ndarray, length: float) -> list[slice]:
        """Cut the contiguous runs of ``mask`` into blocks of about ``length`` samples."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
        result = []
        for start, stop in zip(edges[::2], edges[1::2], strict=True):
            parts = max(1, round((stop - start) / length))
            cuts = np.linspace(start, stop, parts + 1).astype(int)
            result += [slice(a, b) for a, b in pairwise(cuts)]
        return result


def split(samples: int, interval: float, slowest: float, warm_up: float = 0.0) -> Split:
    """Split ``samples`` at ``interval`` (s) with gaps of three of the ``slowest`` times (s).

    Raises
    ------
    InputError
        If the record is too short for three blocks with such gaps.
    """
    gap = max(1, int(np.ceil(_GAP_IN_TIME_CONSTANTS * slowest / interval)))
    skipped = int(np.ceil(warm_up / interval))
    for pattern, in_gaps in _PATTERNS:
        total = sum(weight for _, weight in pattern)
        usable = samples - skipped - gap * (len(pattern) - 1)
        shortest = usable * min(weight for _, weight in pattern) / total
        if shortest < max(in_gaps * gap, 10):
            continue
        masks = {role: np.zeros(samples, bool) for role in ("fit", "select", "certify")}
        position = float(skipped)
        for role, weight in pattern:
            length = usable * weight / total
            masks[role][round(position) : round(position + length)] = True
            position += length + gap
        return Split(**masks, gap=gap)
    pattern, in_gaps = _PATTERNS[-1]
    shortest = 5 * max(in_gaps * gap, 10)
    needed = skipped + gap * (len(pattern) - 1) + shortest
    raise InputError(
        f"the record holds {samples * interval:g} s; with a slowest time constant of "
        f"{slowest:g} s the split needs {needed * interval:g} s",
        field="record",
        remedy="Record longer, or give the case a shorter `split.slowest_time`",
    )
