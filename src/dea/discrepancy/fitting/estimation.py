"""The parameters of an answer, estimated with what it leaves as the noise.

The search weighs each sample by the noise floor. An answer leaves more of a real device: with so
small a noise its laws follow errors that are not theirs, far from their priors, and fail beyond the
range that was seen.
"""

from collections.abc import Iterator

import numpy as np

from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem
from dea.simulation import TIMING_OFFSET

# First steps from every start, how many of the best go on, and their steps and tolerance: priors
# that draw a fit along a flat valley need more steps than the search has.
_FIRST, _GO_ON, _ITERATIONS, _TOLERANCE = 8, 4, 40, 1e-5
# Difference of costs, in squares of the assumed noise, below which two fits count as equally good.
_AS_GOOD = 3.84


def with_its_error(problem: Problem, fitted: Fit, clean: float) -> Problem:
    """Return the record with what a fit leaves as the noise, if that is over ``clean`` times it."""
    left = problem.seen_rmse(fitted.residual)
    return problem.with_noise(left) if left > clean * problem.noise else problem


def at_its_error(problem: Problem, fitted: Fit, clean: float, workers: int = 1) -> Fit:
    """Return a fit estimated again on the record :func:`with_its_error`.

    It goes on from where it is, from the prior means of its laws, and from all of their starts;
    events keep their instants. The fit itself is returned where the noise stays as it is.
    ``workers`` are threads, on which the result does not depend.
    """
    within = with_its_error(problem, fitted, clean)
    if within is problem:
        return fitted
    # Samples that a fit does not see may have dated an event.
    columns = Columns(held=fitted.extended.layout.events)

    def stepped(start: np.ndarray, steps: int) -> Fit:
        return fit(
            within,
            fitted.extended,
            start,
            iterations=steps,
            tolerance=_TOLERANCE,
            columns=columns,
        )

    first = in_parallel(
        lambda start: stepped(start, _FIRST), list(_starts(fitted)), workers, "starts of the answer"
    )
    first.sort(key=lambda each: each.cost)
    ends = in_parallel(
        lambda each: stepped(each.coordinates, _ITERATIONS),
        first[:_GO_ON],
        workers,
        "last fits of the answer",
    )
    return min(ends, key=lambda each: each.cost)


def _starts(fitted: Fit) -> Iterator[np.ndarray]:
    """Yield coordinates (k,) to estimate from; those of events are always the fit's own.

    One law at a time is put to each of its starts, beside the simulation as it is fitted and as its
    priors have it.
    """
    extended, own = fitted.extended, fitted.coordinates
    yield own
    yield np.where(extended.layout.of_laws & ~extended.layout.events, 0.0, own)
    for beside in (own, np.where(extended.layout.of_laws, own, 0.0)):
        for law, part in zip(extended.attached, extended.layout.effect_slices, strict=True):
            for start in law.effect.starts(law.scales):
                values = extended.layout.values(beside)
                values[part] = law.started(start)
                yield np.where(extended.layout.events, own, extended.layout.coordinates(values))


def on_whole_record(problem: Problem, fitted: Fit, clean: float) -> Fit:
    """Return a fit estimated again on all samples of the record :func:`with_its_error`.

    The certified ones are among them. Where an effect explains the record as well without a timing
    offset, there is none: a delay or a lag then counts in full.
    """
    whole = with_its_error(problem, fitted, clean).whole()
    free = fit(whole, fitted.extended, fitted.coordinates)
    names = [fitted.extended.layout.names[i] for i in fitted.extended.layout.free]
    if TIMING_OFFSET not in names:
        return free
    timing = np.array([name == TIMING_OFFSET for name in names])
    start = np.where(timing, 0.0, free.coordinates)
    held = fit(whole, fitted.extended, start, columns=Columns(held=timing))
    return held if held.cost <= free.cost + _AS_GOOD else free
