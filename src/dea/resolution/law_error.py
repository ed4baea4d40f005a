"""The error that is expected on a further excitation, before its record is seen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from dea.resolution.error import Error

# Factor from one error to the next that an explanation which is not offered may have.
_APART = 2.0


class Motion(NamedTuple):
    """How far an output moves, and how much from sample to sample: standard deviations."""

    size: float
    pace: float

    @classmethod
    def of(cls, *outputs: np.ndarray, apart: int = 1) -> Self:
        """Return that in the outputs of one record or several, each (n,).

        The pace is that between samples that are so many ``apart``.
        """
        steps = [y[apart:] - y[:-apart] for y in outputs]
        return cls(float(np.std(np.concatenate(outputs))), float(np.std(np.concatenate(steps))))

    def beyond(self, other: "Motion") -> float:
        """Return the factor by which this motion is larger or faster than another; one if not."""
        ratios = (
            own / before
            for own, before in zip(self, other, strict=True)
            if np.isfinite(own) and before > 0.0
        )
        return max(1.0, *ratios, 0.0)


class Errors(NamedTuple):
    """Errors on a record: of the right explanation, and those that one not offered may have."""

    right: Error
    another: tuple[Error, ...]


@dataclass(frozen=True)
class LawError:
    """The error on the records so far, and on a further one.

    The law of a right effect is an approximation. Its error grows with the motion it acts on, so
    that an excitation which moves the device further or faster makes it larger; and it is at least
    a part of what the effects do.

    Parameters
    ----------
    seen
        Error on the records so far.
    motion
        Motion in them; its pace is that over one of their sampling intervals, which is ``apart``
        samples of a further record.
    share
        Part of what the effects do that a right law may leave.
    unexplained
        What the simulation without effects leaves beyond the white noise on the records so far: an
        explanation that is not offered is up to so far from those that are.
    allowed
        Part of it that an explanation may leave and still be right.
    apart
        Samples of a further record in one sampling interval of the records so far.
    """

    seen: Error
    motion: Motion
    share: float
    unexplained: float = 0.0
    allowed: float = 0.0
    apart: int = 1

    def on(
        self,
        outputs: Sequence[np.ndarray],
        probabilities: Sequence[float],
        without: np.ndarray,
    ) -> Errors:
        """Return the errors where explanations predict ``outputs``, each (n,)."""
        finite = [bool(np.isfinite(y).all()) for y in outputs]
        weights = np.array(probabilities) * finite
        shown = [y for y, good in zip(outputs, finite, strict=True) if good]
        if not weights.sum() > 0.0:
            return Errors(self.seen, self._beyond(self.seen, self.unexplained))
        weights = weights[finite] / weights.sum()
        gap = 0.0  # where the simulation alone diverges, it does not say what the effects do
        if np.isfinite(without).all():
            gap = float(np.sqrt(weights @ [np.mean((y - without) ** 2) for y in shown]))
        factor = float(
            weights @ [Motion.of(y, apart=self.apart).beyond(self.motion) for y in shown]
        )
        grown = replace(self.seen, coloured=factor * self.seen.coloured)
        right = grown.at_least(self.share * gap)
        return Errors(right, self._beyond(right, factor * self.unexplained))

    def _beyond(self, right: Error, largest: float) -> tuple[Error, ...]:
        """Return errors too large for a right explanation, up to the ``largest``."""
        least = max(_APART * right.coloured, self.allowed * largest)
        if not 0.0 < least < largest:
            return (right.at_least(max(least, largest)),)
        count = 1 + int(np.ceil(np.log(largest / least) / np.log(_APART)))
        return tuple(right.at_least(float(each)) for each in np.geomspace(least, largest, count))
