"""Events that no seen sample dates: they happened around the certified block."""

from typing import NamedTuple

import numpy as np

from dea.discrepancy.fitting.fit import Columns, Fit, at, cost_of, fit
from dea.discrepancy.problem.problem import Problem

# Instants that are tried in the stretch around the certified block, and around the best of these.
_TRIED, _AROUND = 64, 41
# Rise of the seen samples' misfit, in that of a sample, up to which an instant does as well.
_AS_WELL = 10.0


class _Start(NamedTuple):
    """Coordinates (k,), their cost, and the instant (s) that they have other than the fit's own."""

    coordinates: np.ndarray
    cost: float
    place: float | None = None


def with_events_dated(problem: Problem, fitted: Fit) -> Fit:
    """Return a fit with an event dated by all samples, if no seen one dates it.

    An event between the last seen sample before the certified block and the first one after it
    explains the seen samples about as well at any instant between them. Its instant and how long
    it took are then fitted to all samples; all else stays as it was fitted to the seen ones. The
    fit may have ended a few samples outside, where the device has hardly moved yet. It is
    returned itself if there is no such event, if no other instant is better, or of several records.
    """
    extended = fitted.extended
    if len(fitted.records) > 1 or not problem.certify.any():
        return fitted
    tried = np.linspace(*_undated(problem), _TRIED)
    for part in extended.layout.effect_slices:
        events, instants = (
            [i for i in extended.layout.free[those] if part.start <= i < part.stop]
            for those in (extended.layout.events, extended.layout.instants)
        )
        if instants:
            fitted = _dated(problem, fitted, events, instants, tried)
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

    They start where a fit to the seen samples left them, or at one of the instants ``tried`` (s)
    that explains these as well, or at a better one around that.
    """
    extended, whole = fitted.extended, problem.whole()
    left = cost_of(fitted.residual, fitted.coordinates, whole)
    seen = cost_of(fitted.residual, fitted.coordinates, problem)
    inside = any(tried[0] <= fitted.values[i] <= tried[-1] for i in instants)
    most = np.inf if inside else seen * (1.0 + _AS_WELL / problem.seen.sum())

    def best_of(places: np.ndarray, before: _Start) -> _Start:
        found = before
        for place in places:
            values = fitted.values.copy()
            values[instants] = place
            x, residual = extended.layout.coordinates(values), problem.residual(extended, values)
            cost = cost_of(residual, x, whole)
            if cost < found.cost and cost_of(residual, x, problem) <= most:
                found = _Start(x, cost, place)
        return found

    start = best_of(tried, _Start(fitted.coordinates, left))
    if start.place is not None:
        around = np.linspace(-1.0, 1.0, _AROUND) * (tried[1] - tried[0])
        start = best_of(start.place + around, start)
    elif not inside:
        return fitted
    held = np.array([i not in events for i in extended.layout.free])
    best = fit(whole, extended, start.coordinates, columns=Columns(held=held))
    return at(problem, extended, best.coordinates) if best.cost < left else fitted
