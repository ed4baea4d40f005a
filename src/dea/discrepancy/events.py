"""Events that no seen sample dates: they happened around the certified block."""

import numpy as np

from dea.discrepancy.fit import Columns, Fit, at, cost_of, fit
from dea.discrepancy.problem import Problem

# Instants that are tried in the stretch around the certified block, before the best is refined.
_TRIED = 64


def with_events_dated(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit with an event dated by all samples, if no seen one dates it.

    An event between the last seen sample before the certified block and the first one after it
    explains the seen samples about as well at any instant between them. Its instant and how long
    it took are then fitted to all samples; all else stays as it was fitted to the seen ones. The
    fit itself is returned if there is no such event, if no other instant is better, or of several
    records.
    """
    extended = fitted.extended
    if len(fitted.records) > 1 or not problem.certify.any():
        return fitted
    early, late = _undated(problem)
    for part in extended.effect_slices:
        events, instants = (
            [i for i in extended.free[those] if part.start <= i < part.stop]
            for those in (extended.events, extended.instants)
        )
        if any(early <= fitted.values[i] <= late for i in instants):
            fitted = _dated(problem, fitted, events, instants, np.linspace(early, late, _TRIED))
    return fitted


def _undated(problem: Problem) -> tuple[float, float]:
    """Return the ends (s) of the stretch without seen samples around the certified block."""
    first, last = np.flatnonzero(problem.certify)[[0, -1]]
    before, after = np.flatnonzero(problem.seen[:first]), np.flatnonzero(problem.seen[last:])
    start = before[-1] if before.size else 0
    stop = last + after[0] if after.size else problem.size - 1
    return problem.interval * float(start), problem.interval * float(stop)


def _dated(
    problem: Problem, fitted: Fit, events: list[int], instants: list[int], tried: np.ndarray
) -> Fit:
    """Return the fit with the ``events`` (places of parameters) of one effect as all samples say.

    They start where a fit to the seen samples left them, or at one of the instants ``tried`` (s).
    """
    extended, whole = fitted.extended, problem.whole()
    values = np.tile(fitted.values, (tried.size + 1, 1))
    values[1:, instants] = tried[:, np.newaxis]
    starts = [extended.coordinates(each) for each in values]
    costs = [cost_of(whole.residual(extended, extended.values(x)), x, whole) for x in starts]
    held = np.array([i not in events for i in extended.free])
    best = fit(whole, extended, starts[int(np.argmin(costs))], columns=Columns(held=held))
    return at(problem, extended, best.coordinates) if best.cost < costs[0] else fitted
