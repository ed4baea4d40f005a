"""How far a free run may leave the outputs that were measured."""

import numpy as np

from dea.arrays import Array
from dea.narx.simulation import simulate
from dea.terms import Term

# Times the largest measured output. A model that leaves it on inputs of the amplitudes and the
# spectrum of a record is bounded on that record alone.
LEEWAY = 3.0
# The same, beyond which a run has diverged. It is wider since gains at rest may exceed those
# recorded.
DIVERGED = 100.0


def stays_in_range(terms: tuple[Term, ...], parameters: Array, u: Array, y: Array) -> bool:
    """Whether the free run on ``u`` from the first of ``y`` stays within the leeway of ``y``."""
    run = simulate(terms, parameters, u, y, bound=LEEWAY * float(np.abs(y).max()))
    return bool(np.isfinite(run[-1]))
