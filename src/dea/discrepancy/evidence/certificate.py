"""Certify an extension on samples, and on records, that chose nothing.

Nor was anything fitted to them but the date of an event that happened there.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.evidence.model_error import memory_of
from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.problem.problem import Problem, Samples, rmse
from dea.missing import filled
from dea.simulation import ExtendedSimulation

# Part of the known outputs of another record, from its start, that its initial state is fitted to.
_HEAD = 0.1


@dataclass(frozen=True)
class Certified:
    """Free-run errors before and after, in the output's unit, on so many certified samples."""

    before: float
    after: float
    samples: int

    def worse(self, noise: float) -> bool:
        """Return whether the error has grown, and is more than noise."""
        return not self.after <= max(self.before, noise)

    @property
    def diverges(self) -> bool:
        """Whether the extended simulation alone runs away."""
        return bool(np.isfinite(self.before) and not np.isfinite(self.after))


@dataclass(frozen=True)
class Certificate:
    """The errors on the certified block, and on each other record by name.

    ``dated`` says whether the certified samples dated an event, which they then do not certify.
    """

    block: Certified
    records: Mapping[str, Certified]
    dated: bool = False


def certify(problem: Problem, nominal: Fit, extended: Fit) -> Certified:
    """Compare both simulations on the certified block."""
    return Certified(
        rmse(nominal.residual, problem.certify),
        rmse(extended.residual, problem.certify),
        int(problem.certify.sum()),
    )


def transferable(extended: ExtendedSimulation) -> bool:
    """Return whether all effects are properties of the device and not of one record's time."""
    return all(a.effect.transferable for a in extended.attached)


def has_course_of_reading(extended: ExtendedSimulation) -> bool:
    """Return whether an effect is a course in time of the reading alone, as a drift or hum is."""
    laws = (a.effect for a in extended.attached)
    return any(law.only_reads and not law.transferable for law in laws)


def certify_elsewhere(
    others: Mapping[str, Samples], nominal: Fit, extended: Fit
) -> dict[str, Certified]:
    """Compare the free-run errors of both simulations on other records.

    An extension that describes what happened during its record says nothing about others: then
    there are none to compare.
    Only the state of the device at the start is chosen, on the first tenth of the known outputs:
    that of a record that was diagnosed, or one fitted there. That tenth counts in the errors, as it
    does in published ones.
    """
    return {
        name: Certified(
            _error_on(other, nominal),
            _error_on(other, extended),
            int(np.count_nonzero(~np.isnan(other.y))),
        )
        for name, other in (others if transferable(extended.extended) else {}).items()
    }


def contradicting(found: Mapping[str, Certified], noise: float) -> dict[str, Certified]:
    """Return the records that together contradict an extension, if any do.

    On more than half of them it is worse than the simulation alone and leaves more than noise, or
    it runs away on one.
    """
    worse = {name: each for name, each in found.items() if each.worse(noise)}
    several = 2 * len(worse) > len(found)
    return worse if several or any(each.diverges for each in worse.values()) else {}


def _error_on(other: Samples, fitted: Fit) -> float:
    y = _from_its_own_start(other, fitted)
    return rmse(other.y - y, ~np.isnan(other.y))


def _from_its_own_start(other: Samples, fitted: Fit) -> np.ndarray:
    """Return the output (n,) on another record from the start that its first outputs suggest.

    A slow state is hardly seen in so short a time, and going on from a poor estimate of it may be
    far off. A start that is known from another record needs no estimate; the fitted one is taken
    where it explains the tenth better by more than its freedom is worth (the Bayesian information
    criterion).
    """
    joint, extended = fitted.extended, fitted.extended.alone.as_recorded
    records = range(max(1, len(joint.lengths)))
    known = [joint.layout.of_record(fitted.values, number) for number in records]
    if not extended.layout.at_start.any():
        return extended.simulate(known[0], other.u, other.interval)
    outputs, seen = filled(other.y)
    head = seen & (np.cumsum(seen) <= max(10, round(_HEAD * seen.sum())))
    nothing = np.zeros_like(head)
    noise = max(rmse(fitted.residual, np.isfinite(fitted.residual)), 1e-12)
    problem = Problem(other.u, outputs, other.interval, head, nothing, nothing, noise)
    held = Columns(held=~extended.layout.at_start)
    own = fit(problem, extended, extended.layout.coordinates(known[0]), iterations=10, columns=held)
    tried = [extended.simulate(each, other.u, other.interval) for each in (*known, own.values)]
    errors = [rmse(other.y - y, head) for y in tried]
    nearest = int(np.argmin(np.nan_to_num(errors[:-1], nan=np.inf)))
    if not np.isfinite(errors[nearest]):
        return tried[-1]
    if not np.isfinite(errors[-1]):
        return tried[nearest]
    # Errors that are alike from sample to sample count as fewer.
    samples = max(head.sum() / memory_of((other.y - tried[nearest])[head], 0.0), 1.0)
    least = np.finfo(float).tiny
    gained = samples * np.log(max(errors[nearest], least) / max(errors[-1], least))
    charge = 0.5 * int(extended.layout.at_start.sum()) * np.log(head.sum())
    return tried[-1] if gained > charge else tried[nearest]
