"""What this record could show of an effect at all."""

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import unabsorbed

DETECTABLE = 0.2


def signature(problem: Problem, before: Fit, candidate: Fit) -> tuple[float, float]:
    """Return size and remaining part of what an effect does to the output at its fitted shape.

    The size is the root mean square, in units of the noise, of what the effect's parameters
    change within one prior spread, after the simulation's own parameters have been refitted to
    take up as much of it as they can. The part is what was left of it then.
    """
    seen = problem.seen
    own = before.coordinates.size
    J = candidate.jacobian[seen]
    if J.shape[1] <= own or not np.isfinite(J).all():
        return 0.0, 0.0
    law = J[:, own:]
    rest = unabsorbed(J[:, :own], problem.noise)(law)
    energy, left = np.sum(law**2, axis=0), np.sum(rest**2, axis=0)
    size = float(np.sqrt(left.max() / seen.sum()) / problem.noise)
    return size, float(np.sqrt(left.max() / max(energy.max(), 1e-300)))
