"""Split a record into contiguous blocks: to fit on, to choose by, and to certify on, once."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dea.errors import InputError
from dea.inputs import by_input

# Between blocks lie as many of the slowest time constants, or fewer where the record is short.
_TIME_CONSTANTS = 3.0
# Samples of the shortest block.
_SHORTEST = 10
# Part of the input's range by which the certified block may go beyond the others.
_BEYOND = 0.02
# Part of its outputs that may be missing.
_MISSING = 0.5
# Part by which a time that is stated is below the largest one, so that no rounding exceeds it.
_BELOW = 1e-9


class _Pattern(NamedTuple):
    """Blocks to fit on and to choose by in turn, so that both see slow changes and rare events.

    The number of such ``blocks``, the length of the certified block in theirs, and the least length
    of a block in spacings.
    """

    blocks: int
    certified: float
    in_spacings: float

    @property
    def shortest_blocks(self) -> float:
        """Return how often all blocks together hold the shortest one."""
        return (self.blocks + self.certified) / min(1.0, self.certified)

    def least(self, spacing: int) -> float:
        """Return the samples that it needs with this spacing."""
        shortest = max(self.in_spacings * spacing, _SHORTEST)
        return spacing * self.blocks + self.shortest_blocks * shortest

    @property
    def in_all(self) -> float:
        """Return the spacings that all blocks and what is between them take at least."""
        return self.blocks + self.shortest_blocks * self.in_spacings

    def widest(self, size: int) -> int:
        """Return the widest spacing with which it needs no more than ``size`` samples."""
        return int(min(size / self.in_all, (size - self.shortest_blocks * _SHORTEST) / self.blocks))


# The first that the record is long enough for is used.
_PATTERNS = (_Pattern(18, 3.0, 3.0), _Pattern(8, 1.5, 1.0), _Pattern(3, 0.75, 1.0))
# The slowest time constants of a record that is not close.
LONG_ENOUGH = _PATTERNS[-1].in_all * _TIME_CONSTANTS


@dataclass(frozen=True)
class Split:
    """Masks over the samples of a record, and the spacing between blocks.

    The spacing is given in samples, and in the slowest time constants of the device; ``slowest`` is
    that time in samples, 0 where no mode decays. Of several records ``closest`` is the number of
    the one whose blocks are the least time constants apart.
    """

    fit: np.ndarray
    select: np.ndarray
    certify: np.ndarray
    spacing: int
    time_constants: float = _TIME_CONSTANTS
    slowest: float = np.inf
    closest: int = 1

    @property
    def close(self) -> bool:
        """Whether the record is too short for blocks as far apart as they ought to be."""
        return self.time_constants < _TIME_CONSTANTS

    @property
    def largest_slowest(self) -> float:
        """Slowest time, in samples, up to which a ``close`` record would not be close."""
        return self.time_constants * self.slowest / _TIME_CONSTANTS


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

    A record that is too short for three blocks with such spacings gets the widest that it allows,
    of one ``slowest`` time at least. Several inputs are columns. Where outputs are missing, half of
    those of the certified block are ``known`` (n, bool), if they are at any place.

    The certified block lies inside the record, so that a drift is interpolated in it, and as near
    the middle as possible without its input leaving the range of the other blocks: there, no
    candidate could have been fitted.

    Raises
    ------
    InputError
        If the record is too short for three blocks with spacings of one ``slowest`` time.
    """
    slow = slowest / interval
    skipped, size = int(np.ceil(warm_up / interval)), len(u)
    spacing = max(1, int(np.ceil(_TIME_CONSTANTS * slow)))
    for pattern in _PATTERNS:
        if skipped + pattern.least(spacing) <= size:
            return replace(_placed_best(u, known, skipped, spacing, pattern), slowest=slow)
    widest, narrowest = _PATTERNS[-1].widest(size - skipped), int(np.ceil(max(1.0, slow)))
    if widest >= narrowest:
        found = _placed_best(u, known, skipped, widest, _PATTERNS[-1])
        return replace(found, time_constants=widest / slow, slowest=slow)
    needed = shortest_record(narrowest, skipped)
    raise InputError(
        f"the record holds {size * interval:g} s; with a slowest time constant of "
        f"{slowest:g} s the split needs {needed * interval:g} s",
        field="record",
        remedy=_longer(widest * interval, shortest_record(1, skipped)),
    )


def _longer(largest: float, least: float) -> str:
    """Say what to do about a record that can be split up to a ``largest`` slowest time (s).

    Where that is zero, it holds fewer samples than the ``least`` of any record.
    """
    keys = "`split.slowest_time` of a case, dea.discrepancy.Settings(slowest_time=…) in Python"
    if largest <= 0.0:
        return f"Record longer: whatever the time ({keys}), it needs {np.ceil(least):.0f} samples"
    return (
        "Record longer, or if the device is faster than this, say so: the record allows a time of "
        f"at most {rounded_down(largest):g} s ({keys})"
    )


def rounded_down(time: float) -> float:
    """Return the largest time of three significant digits that is below ``time``, above zero."""
    place = int(np.floor(np.log10(time))) - 2
    return float(np.floor(time * (1.0 - _BELOW) / 10.0**place)) * 10.0**place


def shortest_record(spacing: int, skipped: int = 0) -> float:
    """Return the samples of the shortest record that can be split with this ``spacing``."""
    return skipped + _PATTERNS[-1].least(spacing)


def _placed_best(
    u: np.ndarray, known: np.ndarray | None, skipped: int, spacing: int, pattern: _Pattern
) -> Split:
    """Return the split by a pattern with the best place of the certified block (:func:`_unfit`)."""
    candidates = _placed(len(u), skipped, spacing, pattern)
    return min(candidates, key=partial(_unfit, by_input(u), known))


def _placed(samples: int, skipped: int, spacing: int, pattern: _Pattern) -> Iterator[Split]:
    """Yield the splits with the certified block at each place inside, the middle first."""
    count, certified, _ = pattern
    usable = samples - skipped - spacing * count
    for place in sorted(range(1, count), key=lambda place: abs(2 * place - count)):
        roles = [("fit", "select")[i % 2] for i in range(count)]
        roles.insert(place, "certify")
        masks = {role: np.zeros(samples, bool) for role in ("fit", "select", "certify")}
        position = float(skipped)
        for role in roles:
            length = usable / (count + certified) * (certified if role == "certify" else 1.0)
            masks[role][round(position) : round(position + length)] = True
            position += length + spacing
        yield Split(masks["fit"], masks["select"], masks["certify"], spacing)


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
