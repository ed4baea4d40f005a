"""Split a record into contiguous blocks: to fit on, to choose by, and to certify on, once."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from dea.errors import InputError
from dea.inputs import by_input
from dea.missing import runs

# Blocks to fit on and to choose by alternate, so that both see changes with time and rare events.
# Each pattern is the number of such blocks, the length of the certified block in theirs, and the
# least length of a block in spacings; the first pattern that the record is long enough for is used.
_PATTERNS = ((18, 3.0, 3.0), (8, 1.5, 1.0), (3, 0.75, 1.0))
_SPACING_IN_TIME_CONSTANTS = 3.0
# Part of the input's range by which the certified block may go beyond the others.
_BEYOND = 0.02
# Part of its outputs that may be missing.
_MISSING = 0.5


@dataclass(frozen=True)
class Split:
    """Masks over the samples of a record, and the spacing (samples) between blocks."""

    fit: np.ndarray
    select: np.ndarray
    certify: np.ndarray
    spacing: int

    def blocks(self, mask: np.ndarray, length: float) -> list[slice]:
        """Cut the contiguous runs of ``mask`` into blocks of about ``length`` samples."""
        return cut(runs(mask), length)


def cut(blocks: Iterable[slice], length: float) -> list[slice]:
    """Cut blocks into parts of about ``length`` samples."""
    result = []
    for block in blocks:
        parts = max(1, round((block.stop - block.start) / length))
        cuts = np.linspace(block.start, block.stop, parts + 1).astype(int)
        result += [slice(a, b) for a, b in pairwise(cuts)]
    return result


def split(
    u: np.ndarray,
    interval: float,
    slowest: float,
    warm_up: float = 0.0,
    known: np.ndarray | None = None,
) -> Split:
    """Split a record of input ``u`` (n,) with spacings of three of the ``slowest`` times (s).

    Several inputs are columns. Where outputs are missing, half of those of the certified block are
    ``known`` (n, bool), if they are at any place.

    The certified block lies inside the record, so that a drift is interpolated in it, and as near
    the middle as possible without its input leaving the range of the other blocks: there, no
    candidate could have been fitted.

    Raises
    ------
    InputError
        If the record is too short for three blocks with such spacings.
    """
    spacing = max(1, int(np.ceil(_SPACING_IN_TIME_CONSTANTS * slowest / interval)))
    skipped, size = int(np.ceil(warm_up / interval)), len(u)
    for count, certified, in_spacings in _PATTERNS:
        usable = size - skipped - spacing * count
        if usable / (count + certified) * min(1.0, certified) < max(in_spacings * spacing, 10):
            continue
        candidates = _placed(size, skipped, spacing, usable, count, certified)
        return min(candidates, key=partial(_unfit, by_input(u), known))
    needed = shortest_record(spacing, skipped) * interval
    raise InputError(
        f"the record holds {size * interval:g} s; with a slowest time constant of "
        f"{slowest:g} s the split needs {needed:g} s",
        field="record",
        remedy="Record longer, or give the case a shorter `split.slowest_time`",
    )


def shortest_record(spacing: int, skipped: int = 0) -> float:
    """Return the samples of the shortest record that can be split with this ``spacing``."""
    count, certified, in_spacings = _PATTERNS[-1]
    shortest = (count + certified) / min(1.0, certified) * max(in_spacings * spacing, 10)
    return skipped + spacing * count + shortest


def _placed(
    samples: int, skipped: int, spacing: int, usable: int, count: int, certified: float
) -> Iterator[Split]:
    """Yield the splits with the certified block at each place inside, the middle first."""
    for place in sorted(range(1, count), key=lambda place: abs(2 * place - count)):
        roles = [("fit", "select")[i % 2] for i in range(count)]
        roles.insert(place, "certify")
        masks = {role: np.zeros(samples, bool) for role in ("fit", "select", "certify")}
        position = float(skipped)
        for role in roles:
            length = usable / (count + certified) * (certified if role == "certify" else 1.0)
            masks[role][round(position) : round(position + length)] = True
            position += length + spacing
        yield Split(**masks, spacing=spacing)


def _unfit(
    inputs: Iterable[np.ndarray], known: np.ndarray | None, found: Split
) -> tuple[float, float]:
    """Return how far too many certified outputs are missing, and how far the input is beyond."""
    missing = 0.0 if known is None else 1.0 - float(known[found.certify].mean())
    beyond = max(_beyond(each, found) for each in inputs)
    return max(missing - _MISSING, 0.0), max(beyond - _BEYOND, 0.0)


def _beyond(u: np.ndarray, found: Split) -> float:
    """Return by which part of its range the certified input is beyond that of either half."""
    kept = u[found.certify]
    excess = max(
        max(kept.max() - u[half].max(), u[half].min() - kept.min())
        for half in (found.fit, found.select)
    )
    return float(excess / (np.ptp(u) or 1.0))
