"""Held-out residuals: of each block, by parameters that were not fitted to it."""

from collections.abc import Sequence
from math import inf

import numpy as np

from dea.discrepancy.evidence.certificate import transferable
from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.problem.problem import Problem

# Parts of the blocks that are held out in turn, and at least; steps of the fit to the others, from
# where the fit to all of them ended.
_FOLDS, _LEAST_FOLDS, _ITERATIONS = 6, 3, 6
# Part of the output's range by which samples that are held out may reach beyond the others.
_BEYOND = 0.1
# Longest block, as a part of its record, that is held out of an extension with a course in time:
# about one piece of a drift's spline.
_OF_A_COURSE = 0.1
# Deviation of a coordinate by the other blocks, over that by all, from which the others hardly tell
# it: by a ninth of the information.
_UNTOLD = 3.0


class HeldOut:
    """Held-out residuals of fits, each computed once.

    The blocks are dealt into folds, and each is predicted by a fit to all others (Geisser 1975,
    cross-validation). The parameters change so little that the Jacobian of the fit to all is used.
    The state at the start and the instant of an event keep their values of the fit to all, since
    only the blocks that they lie in determine them. So does any other parameter that the other
    blocks hardly tell, such as the slope that a limit leaves, where it is reached in one block:
    else its prior mean would be tested instead of the law. Distant blocks cannot predict a course
    in time: where an extension has one, short blocks are held out and the course is interpolated.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._found: dict[tuple[Fit, bool], np.ndarray] = {}
        self._spread: dict[tuple[Fit, bool], np.ndarray] = {}

    def residual(self, fitted: Fit, beside: Fit | None = None) -> np.ndarray:
        """Return the held-out residual of a fit, shape (n,).

        Samples in no fold keep the residual of the fit to all.

        Where it is compared with one ``beside``, the same blocks are held out of both: short ones
        if either has a course in time.
        """
        key = fitted, _has_course(fitted) or (beside is not None and _has_course(beside))
        if key not in self._found:
            self._found[key], self._spread[key] = self._cross_validated(*key)
        return self._found[key]

    def spread(self, fitted: Fit) -> np.ndarray:
        """Return standard deviations (k,) of the coordinates by the jackknife over the folds.

        They hold whatever the colour of the residual, and where the law is not quite right
        (Tukey 1958, Annals of Mathematical Statistics 29:614). They say little of a coordinate
        that one block alone tells, which does not move without it.
        """
        self.residual(fitted)
        return self._spread[fitted, _has_course(fitted)]

    def rmse(self, fitted: Fit, beside: Fit | None = None) -> float:
        """Return its root mean square over the seen samples."""
        return self._problem.seen_rmse(self.residual(fitted, beside))

    def compared(self, fits: Sequence[Fit]) -> list[float]:
        """Return the root mean square of each fit, the same blocks held out of all."""
        beside = next(filter(_has_course, fits), None)
        return [self.rmse(fitted, beside) for fitted in fits]

    def _cross_validated(self, fitted: Fit, short: bool) -> tuple[np.ndarray, np.ndarray]:
        result = fitted.residual.copy()
        estimates = []
        layout, seen = fitted.extended.layout, self._problem.seen
        by_all = self._variances(fitted, seen)
        for fold in folds(self._problem, fitted.records if short else ()):
            hardly_told = self._variances(fitted, seen & ~fold) > _UNTOLD**2 * by_all
            untold = layout.at_start | layout.events | hardly_told
            again = fit(
                self._problem.seeing(~fold),
                fitted.extended,
                fitted.coordinates,
                iterations=_ITERATIONS,
                columns=Columns(held=untold, kept=fitted.jacobian),
            )
            result[fold] = again.residual[fold]
            estimates.append(again.coordinates)
        return result, np.sqrt(max(len(estimates) - 1, 0)) * np.std(estimates, axis=0)

    def _variances(self, fitted: Fit, samples: np.ndarray) -> np.ndarray:
        """Return the variances (k,) of the coordinates by some ``samples`` (n, bool)."""
        return fitted.covariance(samples, self._problem.noise**2).diagonal()


def _has_course(fitted: Fit) -> bool:
    return not transferable(fitted.extended)


def folds(problem: Problem, courses: Sequence[slice] = ()) -> list[np.ndarray]:
    """Return masks (n, bool) to which the contiguous seen blocks are dealt in turn.

    Neighbouring blocks that a period of the input spans are dealt together: a law that only
    repeats what the other periods show would otherwise be predicted from them. Samples whose output
    lies far outside the outputs of the other folds are not held out: there a curve extrapolates,
    whether it is right or not. Where this leaves fewer than three folds, all blocks are dealt.
    Where each of the records ``courses`` has a course in time of its own, the blocks are short and
    dealt singly.
    """
    short = [
        [block]
        for own in courses
        for block in problem.blocks(_OF_A_COURSE * (own.stop - own.start), own)
    ]
    groups = short or [
        group
        for own, period in zip(problem.records, problem.periods, strict=True)
        for group in _spanning(problem.blocks(inf, own), period)
    ]
    count = min(_FOLDS, len(groups))
    dealt = []
    for first in range(count):
        mask = np.zeros(problem.size, bool)
        for block in (block for group in groups[first::count] for block in group):
            mask[block] = True
        dealt.append(mask)
    inside = [mask & _near_range(problem, problem.seen & ~mask) for mask in dealt]
    inside = [mask for mask in inside if mask.any()]
    return inside if len(inside) >= min(count, _LEAST_FOLDS) else dealt


def _near_range(problem: Problem, samples: np.ndarray) -> np.ndarray:
    """Return where (n,) the output is near the range that it has in some ``samples`` (n, bool)."""
    if not samples.any():
        return np.ones(problem.size, bool)
    low, high = problem.y[samples].min(), problem.y[samples].max()
    margin = _BEYOND * np.ptp(problem.y[problem.seen])
    near: np.ndarray = (problem.y >= low - margin) & (problem.y <= high + margin)
    return near


def _spanning(blocks: list[slice], samples: int) -> list[list[slice]]:
    """Return consecutive blocks of a record in groups that span so many samples, three at least."""
    samples = min(samples, (blocks[-1].stop - blocks[0].start) // _LEAST_FOLDS)
    groups: list[list[slice]] = []
    for block in blocks:
        if groups and groups[-1][-1].stop - groups[-1][0].start < samples:
            groups[-1].append(block)
        else:
            groups.append([block])
    return groups
