"""What this record could show of an effect at all."""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fitting.fit import Fit, at
from dea.discrepancy.fitting.sensitivity import unabsorbed
from dea.discrepancy.problem.problem import Problem


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


def most_visible(problem: Problem, before: Fit, candidate: Fit, enough: float) -> Visibility:
    """Return the visibility of the effect at its fit or, where that is too little, at its starts.

    An effect that is absent is fitted to where it does nothing, such as a stop beyond the motion,
    and no parameter changes anything there: the record shows it all the same.
    """
    found = visibility(problem, before, candidate)
    law = candidate.extended.attached[-1]
    for start in law.effect.starts(law.scales):
        if found.size >= enough:
            break
        values = np.concatenate([before.values, law.started(start)])
        there = at(problem, candidate.extended, candidate.extended.layout.coordinates(values))
        found = max(found, visibility(problem, before, there), key=lambda each: each.size)
    return found
