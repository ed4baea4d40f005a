"""Events that no seen sample dates: they happened around the certified block."""

import numpy as np

from dea.discrepancy.fit import Columns, Fit, at, cost_of, fit
from dea.discrepancy.problem import Problem

# Instants that are tried in the stretch around the certified block, before the best is refined.
_TRIED = 64


def with_events_dated(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit whose events are dated by all samples, if no seen one dates them.

    An event between the last seen sample before the certified block and the first one after it
    explains the seen samples equally well at any instant between them. All else stays as it was
    fitted to the seen samples. Of several records the fit is returned as it is.
    """
    extended = fitted.extended
    instants = [i for i in extended.free if extended.parameters[i].event]
    instants = [i for i in instants if not extended.parameters[i].log]
    if not instants or len(fitted.records) > 1 or not problem.certify.any():
        return fitted
    first, last = np.flatnonzero(problem.certify)[[0, -1]]
    before, after = np.flatnonzero(problem.seen[:first]), np.flatnonzero(problem.seen[last:])
    early = problem.interval * (before[-1] if before.size else 0)
    late = problem.interval * (last + after[0] if after.size else problem.size - 1)
    whole = problem.whole(fitted.records)
    for i in instants:
        if early <= fitted.values[i] <= late:
            tried = [_moved(fitted, i, instant) for instant in np.linspace(early, late, _TRIED)]
            costs = [cost_of(whole.residual(extended, extended.values(x)), x, whole) for x in tried]
            start = tried[int(np.argmin(costs))]
            dated = fit(whole, extended, start, columns=Columns(held=~extended.events))
            fitted = at(problem, extended, dated.coordinates)
    return fitted


def _moved(fitted: Fit, place: int, value: float) -> np.ndarray:
    """Return the coordinates (k,) of a fit with another value at a place of its parameters."""
    values = fitted.values.copy()
    values[place] = value
    return fitted.extended.coordinates(values)
