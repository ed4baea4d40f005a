"""What this record could show of an effect at all."""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import unabsorbed


@dataclass(frozen=True)
class Visibility:
    """How much of an effect a record shows.

    Parameters
    ----------
    size
        RMS change of the output, in units of the noise, by one prior spread of the effect's most
        visible parameter, after the simulation's own parameters have absorbed what they can.
    independent
        Part of the change by that parameter that they cannot absorb.
    """

    size: float
    independent: float


def visibility(problem: Problem, before: Fit, candidate: Fit) -> Visibility:
    """Return the visibility of the effect that a candidate adds, at its fitted parameters."""
    seen = problem.seen
    own = before.coordinates.size
    J = candidate.jacobian[seen]
    if J.shape[1] <= own or not np.isfinite(J).all():
        return Visibility(0.0, 0.0)
    law = J[:, own:]
    rest = unabsorbed(J[:, :own], problem.noise)(law)
    energy, left = np.sum(law**2, axis=0), np.sum(rest**2, axis=0)
    seen_best = int(left.argmax())
    size = float(np.sqrt(left[seen_best] / seen.sum()) / problem.noise)
    return Visibility(size, float(np.sqrt(left[seen_best] / max(energy[seen_best], 1e-300))))
