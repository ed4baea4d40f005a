"""How far a free run may leave the outputs that were measured."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from dea.arrays import Array, Segment
from dea.narx.simulation import simulate
from dea.terms import Term

# Times the largest departure of the measured outputs from their mean. A model whose run goes
# beyond on inputs of the amplitudes and the spectrum of a record is bounded on that record alone.
LEEWAY = 3.0
# Times that departure, or in a fit times the largest modulus of the output, beyond which a run has
# diverged; wider, since gains at rest may exceed those recorded.
DIVERGED = 100.0


class MeasuredRange(NamedTuple):
    """The mean of all measured outputs, and their largest departure from it."""

    mean: float
    departure: float

    @classmethod
    def of(cls, segments: Sequence[Segment]) -> Self:
        """Return that of inputs and outputs."""
        outputs = np.concatenate([y for _, y in segments])
        mean = float(np.mean(outputs))
        return cls(mean, float(np.abs(outputs - mean).max()))


def stays_in_range(
    terms: tuple[Term, ...], parameters: Array, u: Array, y: Array, measured: MeasuredRange
) -> bool:
    """Whether the free run on ``u`` from the first of ``y`` keeps the leeway of what was measured.

    It is fast enough for every candidate of a search.
    """
    most = LEEWAY * measured.departure
    # Beyond this modulus it is out of range, and need not be run to its end.
    run = simulate(terms, parameters, u, y, bound=abs(measured.mean) + most)
    return bool(np.abs(run - measured.mean).max() <= most)


def bound_of(segments: Sequence[Segment]) -> float:
    """Return the modulus of an output beyond which a fit may end the run, its error being hopeless.

    One segment may be at rest throughout.
    """
    return DIVERGED * max(float(np.abs(y).max()) for _, y in segments)
